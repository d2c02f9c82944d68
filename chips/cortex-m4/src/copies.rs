//! Copies, fills and comparisons of memory, as the compiler calls them.
//!
//! They stand in for the functions of `compiler_builtins`, which are weak symbols: 3.1 KB that copy the last bytes one
//! by one. These take a tenth of the room and fewer instructions. Names and arguments are of the ARM run-time ABI
//! (IHI 0043, 5.3.4) and of C. No function needs an aligned address: words are loaded and stored at any address, which
//! the processor does (ARM DDI 0403E, A3.2.1), and several at once only at aligned ones.
//!
//! `boards/qemu` checks them at each length and alignment (`copies_check`).

use core::arch::global_asm;

// r0 to, r1 from, r2 bytes. After each 16 bytes r2 is 16 less than what is left, so its low four bits say what remains
// after the loops: bit 3 in the carry and bit 2 in the sign after a shift by 29, bits 1 and 0 after a shift by 31.
global_asm!(
    ".macro begin_function name:vararg
        .irp one, \\name
        .global \\one
        .type \\one, %function
        .thumb_func
        \\one:
        .endr
    .endm",
    ".section .text.memcpy, \"ax\", %progbits",
    ".p2align 2",
    "begin_function memcpy, __aeabi_memcpy, __aeabi_memcpy4, __aeabi_memcpy8
        push {{r0, r4, r5, lr}}
        orr r3, r0, r1
        subs r2, #16
        blo 3f
        lsls r3, r3, #30
        bne 2f
    1:  ldmia r1!, {{r3, r4, r5, r12}}
        subs r2, #16
        stmia r0!, {{r3, r4, r5, r12}}
        bhs 1b
        b 3f
    2:  ldr r3, [r1], #4
        ldr r4, [r1], #4
        ldr r5, [r1], #4
        ldr r12, [r1], #4
        subs r2, #16
        str r3, [r0], #4
        str r4, [r0], #4
        str r5, [r0], #4
        str r12, [r0], #4
        bhs 2b
    3:  lsls r3, r2, #29
        itttt cs
        ldrcs r3, [r1], #4
        ldrcs r4, [r1], #4
        strcs r3, [r0], #4
        strcs r4, [r0], #4
        itt mi
        ldrmi r3, [r1], #4
        strmi r3, [r0], #4
        lsls r3, r2, #31
        itt cs
        ldrhcs r3, [r1], #2
        strhcs r3, [r0], #2
        itt mi
        ldrbmi r3, [r1]
        strbmi r3, [r0]
        pop {{r0, r4, r5, pc}}
    .size memcpy, . - memcpy",
    // Forwards, unless the destination begins inside the source. A distance taken as unsigned is then less than the
    // length; a destination in front of the source is further away than any length.
    ".section .text.memmove, \"ax\", %progbits",
    ".p2align 2",
    "begin_function memmove, __aeabi_memmove, __aeabi_memmove4, __aeabi_memmove8
        subs r3, r0, r1
        cmp r3, r2
        bhs memcpy
        add r12, r0, r2
        add r1, r2
        subs r2, #4
        blo 2f
    1:  ldr r3, [r1, #-4]!
        subs r2, #4
        str r3, [r12, #-4]!
        bhs 1b
    2:  adds r2, #4
        beq 4f
    3:  ldrb r3, [r1, #-1]!
        subs r2, #1
        strb r3, [r12, #-1]!
        bne 3b
    4:  bx lr
    .size memmove, . - memmove",
    // The ABI's order is r0 to, r1 bytes, r2 value; the order of C is r0 to, r1 value, r2 bytes.
    ".section .text.memset, \"ax\", %progbits",
    ".p2align 2",
    "begin_function memset
        mov r3, r1
        mov r1, r2
        mov r2, r3
        b 1f
    begin_function __aeabi_memclr, __aeabi_memclr4, __aeabi_memclr8
        movs r2, #0
    begin_function __aeabi_memset, __aeabi_memset4, __aeabi_memset8
    1:  uxtb r2, r2
        orr r2, r2, r2, lsl #8
        orr r2, r2, r2, lsl #16
        mov r3, r0
        subs r1, #16
        blo 3f
    2:  str r2, [r3], #4
        subs r1, #16
        str r2, [r3], #4
        str r2, [r3], #4
        str r2, [r3], #4
        bhs 2b
    3:  lsls r12, r1, #29
        itt cs
        strcs r2, [r3], #4
        strcs r2, [r3], #4
        it mi
        strmi r2, [r3], #4
        lsls r12, r1, #31
        it cs
        strhcs r2, [r3], #2
        it mi
        strbmi r2, [r3]
        bx lr
    .size memset, . - memset",
    // Words as long as they are equal, then bytes: the first that differs is among the next four.
    ".section .text.memcmp, \"ax\", %progbits",
    ".p2align 2",
    "begin_function memcmp, bcmp, __aeabi_memcmp
        subs r2, #4
        blo 2f
    1:  ldr r3, [r0]
        ldr r12, [r1]
        cmp r3, r12
        bne 2f
        adds r0, #4
        adds r1, #4
        subs r2, #4
        bhs 1b
    2:  adds r2, #4
    3:  subs r2, #1
        blo 4f
        ldrb r3, [r0], #1
        ldrb r12, [r1], #1
        subs r3, r3, r12
        beq 3b
        mov r0, r3
        bx lr
    4:  movs r0, #0
        bx lr
    .size memcmp, . - memcmp",
    ".text",
);
