; SPDX-License-Identifier: MIT OR Apache-2.0
; Diagonals: along +45 and -45 degrees only two of the four belt motors turn.
G28
G90
G1 X20 Y20 Z1 F9000
G1 X60 Y60
G1 X20 Y20
G1 X60 Y20
G1 X20 Y60
G1 X60 Y20
; Slopes on which both motor pairs turn, at different rates.
G1 X20 Y30
G1 X70 Y45
G1 X25 Y70 F12000
G1 X30 Y20
; Three axes at once.
G1 X50 Y40 Z1.5 F3000
G1 X20 Y20 Z1
M400
