// Drives ReckOn's register-transfer code as the records on stdin say, and writes what it then holds to stdout.
#include "Vreckon.h"
#include "Vreckon___024root.h"
#include "verilated.h"
#include <cstdint>
#include <cstdio>

static uint64_t mixed;
static void mix(uint64_t word) { mixed = (mixed ^ word) * 0x9E3779B97F4A7C15u; mixed ^= mixed >> 29; }
template <class W> static void wide(const W &words, int count) {
    for (int at = 0; at < count; at += 2) mix(uint64_t(words[at + 1]) << 32 | words[at]);
}

static void put(Vreckon &top) {
    auto &r = *top.rootp;
#define S(name) r.reckon__DOT__srnn_0__DOT__##name
    mixed = 0;
    mix(S(state) | S(state_evt) << 4 | S(neur256_cnt) << 8 | S(neur128x2_cnt) << 16 | uint64_t(S(neur_step_cnt)) << 24
        | uint64_t(S(tick_cnt)) << 32);
    mix(S(send_cnt) | S(target_cnt) << 5 | S(e_post_lsb) << 10 | S(e_post_msb) << 15 | S(e_pre) << 19
        | S(buf16_post) << 28 | S(TIMING_ERROR) << 29 | S(got_label) << 30 | uint64_t(S(class_label)) << 32);
    wide(S(neur_z), 8); wide(S(neur_dirty), 8); wide(S(inp_events), 8); wide(S(inp_events_next), 8);
    wide(S(neurons__DOT__Qr), 4); wide(S(weights_inp__DOT__Qr), 4); wide(S(weights_rec__DOT__Qr), 4);
    wide(S(weights_out__DOT__Qr), 4);
    for (int k = 0; k < 16; k++) {
        mix(uint64_t(uint16_t(S(oneur_u)[k])) | uint64_t(uint16_t(S(reg_tar)[k])) << 16
            | uint64_t(uint16_t(S(learning_signals)[k])) << 32 | uint64_t(S(cnt_winner)[k]) << 48);
        mix(uint64_t(S(neur_h)[k] & 31) | uint64_t(S(trace_reg)[k]) << 8);
    }
    mix(S(SRNN_READBACK));
    uint64_t pins = top.MISO | top.AERIN_ACK << 1 | top.OUT_REQ << 2 | top.SPI_RDY << 3 | top.TIMING_ERROR_RDY << 4
        | top.OUT_DATA << 8 | S(state) << 16 | S(state_evt) << 20 | uint64_t(S(neur256_cnt)) << 24;
    fwrite(&pins, 8, 1, stdout);
    fwrite(&mixed, 8, 1, stdout);
}

static void memories(Vreckon &top) {
    auto &r = *top.rootp;
    mixed = 0;
    for (int at = 0; at < 128; at++) wide(S(neurons__DOT__SRAM)[at], 4);
    for (int at = 0; at < 4096; at++) wide(S(weights_inp__DOT__SRAM)[at], 4);
    for (int at = 0; at < 4096; at++) wide(S(weights_rec__DOT__SRAM)[at], 4);
    for (int at = 0; at < 512; at++) wide(S(weights_out__DOT__SRAM)[at], 4);
    uint64_t none = ~0ull;
    fwrite(&none, 8, 1, stdout);
    fwrite(&mixed, 8, 1, stdout);
    fflush(stdout);
}

int main() {
    VerilatedContext context;
    Vreckon top(&context, "");
    top.CLK_INT_EN = 0;
    top.eval();
    uint8_t record[4];
    while (fread(record, 1, 4, stdin) == 4) {
        unsigned pins = record[0] | record[1] << 8;
        if (record[3] == 255) { memories(top); continue; }
        top.RST = pins & 1; top.MOSI = pins >> 2 & 1;
        top.AERIN_REQ = pins >> 3 & 1; top.AERIN_TAR_EN = pins >> 4 & 1; top.SAMPLE = pins >> 5 & 1;
        top.TIME_TICK = pins >> 6 & 1; top.TARGET_VALID = pins >> 7 & 1; top.INFER_ACC = pins >> 8 & 1;
        top.OUT_ACK = pins >> 9 & 1; top.AERIN_ADDR = record[2];
        top.eval();
        top.SCK = pins >> 1 & 1;
        top.eval();
        put(top);
        for (int clock = 0; clock < record[3]; clock++) {
            top.CLK_EXT = 1; top.eval();
            put(top);
            top.CLK_EXT = 0; top.eval();
        }
    }
    fflush(stdout);
}
