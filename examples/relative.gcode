; SPDX-License-Identifier: MIT OR Apache-2.0
; Relative moves: a square, a square within it, and a change of the origin on the way.
G28
G90
G1 X20 Y20 Z1 F6000
G91
G1 X30 F6000
G1 Y30
G1 X-30
G1 Y-30
G1 X5 Y5
G1 X20
G1 Y20
G1 X-20
G1 Y-20
G1 Z0.5 F600
G90
G92 X0 Y0 ; this place is the origin now
G1 X10 Y10 F6000
G1 X0 Y0
G92 X25 Y25
G1 X20 Y20
M400
