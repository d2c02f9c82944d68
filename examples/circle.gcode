; SPDX-License-Identifier: MIT OR Apache-2.0
; Arcs: centre form and radius form, full circles and a helix.
G28
G17
G90
G1 X50 Y50 Z1 F6000
; A full circle has its end where it began; only I and J can say so.
G2 X50 Y50 I15 J0 F6000
G3 X50 Y50 I0 J10
; Half circles by centre, quarter circles by radius.
G2 X70 Y50 I10 J0
G3 X50 Y50 I-10 J0
G2 X60 Y60 R10
G2 X70 Y50 R10
; A negative radius takes the longer way round.
G2 X60 Y40 R-10
G3 X50 Y50 R-10 F3000
; A helix of two turns, then a small circle.
G3 X50 Y50 Z2 I5 J0 P2 F2400
G2 X50 Y50 I0.5 J0 F1200
G1 Z1 F600
M400
; five turns of a small circle, asked for at more than the axes bear
G1 X50 Y50 F12000
G2 X50 Y50 I1 J0 P5 F12000
