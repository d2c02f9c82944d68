; SPDX-License-Identifier: MIT OR Apache-2.0
; Homing: all axes, then single ones, then again from elsewhere.
G28
G1 X20 Y30 Z2 F3000
G28 X
G28 Y
G28 Z
G1 X5 Y5 F3000
G28 X Y
M400
