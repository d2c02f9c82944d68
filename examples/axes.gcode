; SPDX-License-Identifier: MIT OR Apache-2.0
; Straight moves of one axis at a time, to and fro.
G28
G21
G90
M83
G1 X10 Y10 Z2 F6000
G1 X60 F12000
G1 X10
G1 X110 F18000 ; fast enough to cruise at 300 mm/s
G1 X10
G1 Y60 F12000
G1 Y10
G1 Y110 F18000
G1 Y10
G1 Z4 F600
G1 Z2
G1 E5 F1200
G1 E-5
M400
