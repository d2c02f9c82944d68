; SPDX-License-Identifier: MIT OR Apache-2.0
; Overrides and limits, changed between moves without a stop; but for M220: it reaches moves that wait, and how many do is
; a matter of time, so that the steps would not be the same everywhere.
G28
G90
M83
G1 X20 Y20 Z1 F6000
G1 X60 F3000
M400
M220 S150
G1 X20
M400
M220 S50
G1 X60
M400
M220 S100
M221 S120
G1 X20 E1.5 F2400
M221 S100
G1 X60 E1.5
M204 P1000 T1500
G1 X20 F9000
M204 P3000 R2000 T5000
G1 X60
M205 J0.05
G1 X20 Y40
G1 X60 Y20
M205 J0.013
M201 X2000 Y2000
G1 X20
G1 X60
M201 X5000 Y5000
M203 X50 Y50
G1 X20
M203 X300 Y300
G1 X60
M400
