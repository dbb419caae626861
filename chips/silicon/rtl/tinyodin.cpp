// Drives tinyODIN's register-transfer code as the records on stdin say. A record has five bytes: pins, the input bus (two
// bytes), and a number of clocks (two bytes). If bit 7 of the pins is set, the outputs then go to stdout.
#include "VtinyODIN.h"
#include "VtinyODIN___024root.h"
#include "verilated.h"
#include <cstdint>
#include <cstdio>

int main() {
    VerilatedContext context;
    VtinyODIN top(&context, "");
    auto &r = *top.rootp;
    top.eval();
    uint8_t record[5];
    while (fread(record, 1, 5, stdin) == 5) {
        unsigned pins = record[0];
        top.RST = pins & 1; top.MOSI = pins >> 2 & 1; top.AERIN_REQ = pins >> 3 & 1; top.AEROUT_ACK = pins >> 4 & 1;
        top.AERIN_ADDR = record[1] | record[2] << 8;
        top.eval();
        top.SCK = pins >> 1 & 1;
        top.eval();
        for (int clock = record[3] | record[4] << 8; clock > 0; clock--) {
            top.CLK = 1; top.eval();
            top.CLK = 0; top.eval();
        }
        if (pins >> 7) {
            bool idle = r.tinyODIN__DOT__controller_0__DOT__state == 0 && r.tinyODIN__DOT__SCHED_EMPTY
                && !r.tinyODIN__DOT__AEROUT_CTRL_BUSY;
            uint8_t out[2] = {
                uint8_t(top.MISO | top.AERIN_ACK << 1 | top.AEROUT_REQ << 2 | top.SCHED_FULL << 3 | idle << 4),
                uint8_t(top.AEROUT_ADDR),
            };
            fwrite(out, 1, 2, stdout);
            fflush(stdout);
        }
    }
}
