; Motors skip and are set right. On the belt plant, something in the way of the tool, or a motor that is held for 14 ms:
;   corehbot run examples/belt/skip-and-repair.gcode --plant belt --seed 7 --hit 190,203.8,180,14 --break rub:m11:5N@0s
;   corehbot run examples/belt/skip-and-repair.gcode --plant belt --seed 7 --break rub:m11:170N@57.36s+0.014s
G28
G1 Z5 F900
M915                  ; the motors of the belt are aligned
G1 X175 Y188.8 F9000
G1 X195 Y208.8 F6000  ; there is something in the way
G1 X150 Y150
M400
M915 R                ; what has happened? Set it right
G1 X195 Y208.8        ; the print goes on where it was
M400
M122
