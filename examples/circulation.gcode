; The closed belt runs round: with the tool standing, and while it moves.
G28
G1 X40 Y40 F6000
G1 C10 F3000 ; ten millimetres of belt, the tool stands
G1 X60 Y55 C-5 F6000
G1 X80.013 Y40.007 Z2
G91
G1 C2.5
G1 X-3 Y7
G90
G2 X60 Y40 I-10 J0
G1 X40.004 Y40.006
G1 X60.0025
G1 C10
G1 X90 ; the same directions for other motors
G1 C-10
G1 X40
G1 X40 Y40 C0
M114
