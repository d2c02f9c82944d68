; SPDX-License-Identifier: MIT OR Apache-2.0
; Inches: lengths and speeds are in inches between G20 and G21.
G28
G90
G20
G1 X1 Y1 Z0.04 F240
G1 X2 F300
G1 Y2
G2 X2 Y2 I0.25 J0
G1 X1 Y1
G91
G1 X0.5
G1 X-0.5
G90
G21
G1 X30 Y30 F6000
M400
