/* A recorded flight: time in microseconds as uint32_t, then six channels as float, little endian. */
    .section .rodata
    .balign 4
    .global recording
recording:
    .incbin "flight.bin"
    .global recording_end
recording_end:
    .byte 0
    .section .note.GNU-stack, "", %progbits
