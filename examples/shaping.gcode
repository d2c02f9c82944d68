; SPDX-License-Identifier: MIT OR Apache-2.0
; Input shapers and pressure advance: every step comes from single precision, which is the same on every platform.
G28
M83
M593 X F107.5 T2
M593 Y F61.1 T2
M900 K0.05
G1 X50 Y50 Z1 F9000
; corners and a curve at full speed, with filament
G1 X90 E2 F6000
G1 Y80 E1.5
G1 X80 Y90 E.7
G3 X50 Y60 I-20 J-10 E2
G1 E-.8 F2100
G0 X70 Y40 Z1.2 F12000
G0 Z1
G1 E.8 F2100
; the advance changes without a stop, and goes
M900 K0.02
G1 X90 Y45 E1 F4800
M572 S0
G1 X90 Y60 E.6
SET_PRESSURE_ADVANCE ADVANCE=0.03
G1 X50.5 Y60.25 E1.4
; fine pieces of a curve
G1 X50.4 Y60.1 E.006
G1 X50.35 Y59.9 E.006
G1 X50.35 Y59.7 E.006
G1 X50.4 Y59.5 E.006
G1 X50.5 Y59.3 E.006
G1 X60 Y50 E.5
; one of each
M593 F40 D0.08 T0
G1 X80 Y51 E1
M593 F60 T1
G1 X60 Y49 E1
M593 X F60 T3
M593 Y F45 T4
G1 X80 Y70 E1
G2 X60 Y50 I-10 J-10 E1
M593 F0
M572 W0.02
G1 X50 Y50 E1
M400
