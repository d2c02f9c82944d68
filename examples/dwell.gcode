; SPDX-License-Identifier: MIT OR Apache-2.0
; Waits: a dwell is timed motion without steps, M400 waits until all is done.
G28
G90
G1 X20 Y20 Z1 F6000
G4 P250
G1 X40
G4 S1
G1 X20
M400
G4 P0
G1 Y40
G1 Y20
M400
M400
