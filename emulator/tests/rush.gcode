; SPDX-License-Identifier: MIT OR Apache-2.0
; More step events than the prototype's limits allow: both pairs of belt motors near 36,000 steps a second,
; seldom in the same tick, and an extruder that may run three times as fast as it should.
; It takes the place where it is for its home.
G92 X0 Y0 Z0
M83
M203 E240
G1 X10 Y100 F6000
G1 X380 Y110 E175 F27000
G1 X10 Y100 E175
M400
