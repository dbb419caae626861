/* A plugin of QEMU: adds up the cycles of what is executed, from a table of what each instruction takes.
 *
 * Arguments: table=<file> of lines "address next least most taken_least taken_most", and cycles=<file>, of which the
 * firmware reads two words of 32 bits: at each semihosting call the sums so far are put there. */
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* QEMU's interface for plugins, as much of it as is used: its header is in no package of the distribution. */
typedef uint64_t plugin_id;
typedef uint32_t meminfo;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { NO_REGISTERS = 0, MEMORY_READ_AND_WRITE = 3 };
typedef void (*translated)(plugin_id, struct qemu_plugin_tb *);
typedef void (*executed)(unsigned int, void *);
typedef void (*accessed)(unsigned int, meminfo, uint64_t, void *);
void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, translated);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, executed, int, void *);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, executed, int, void *);
void qemu_plugin_register_vcpu_mem_cb(struct qemu_plugin_insn *, accessed, int, int, void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
unsigned int qemu_plugin_mem_size_shift(meminfo);
bool qemu_plugin_mem_is_store(meminfo);

#define EXPORTED __attribute__((visibility("default")))
EXPORTED int qemu_plugin_version = VERSION;

struct cost {
    uint32_t address, next, least, most, taken_least, taken_most;
};
static struct cost *costs;
static size_t known;
static int sums = -1;

static uint32_t least, most;
/* The last block's last instruction, if it is a branch that may not be taken. */
static const struct cost *branch;

struct block {
    uint32_t address, least, most;
    const struct cost *branch;
};

static void run(unsigned int cpu, void *data) {
    const struct block *block = data;
    (void)cpu;
    if (branch && branch->next != block->address) {
        least += branch->taken_least;
        most += branch->taken_most;
    }
    least += block->least;
    most += block->most;
    branch = block->branch;
}

/* Words at odd halfwords take a cycle more, those at odd bytes two, and halfwords there one. */
static void access_memory(unsigned int cpu, meminfo info, uint64_t address, void *data) {
    (void)cpu, (void)data;
    unsigned int shift = qemu_plugin_mem_size_shift(info);
    uint32_t more = 0;
    if (shift > 0 && address & 1) more = shift;
    else if (shift > 1 && address & 2) more = 1;
    /* A store that is late does not hold the core up, or does. */
    if (!qemu_plugin_mem_is_store(info)) least += more;
    most += more;
}

static void tell(unsigned int cpu, void *data) {
    (void)cpu, (void)data;
    uint32_t both[2] = {least, most};
    if (pwrite(sums, both, sizeof both, 0) != sizeof both) abort();
}

static int by_address(const void *a, const void *b) {
    const struct cost *one = a, *other = b;
    return (one->address > other->address) - (one->address < other->address);
}

static void translate(plugin_id id, struct qemu_plugin_tb *tb) {
    (void)id;
    size_t count = qemu_plugin_tb_n_insns(tb);
    struct block *block = calloc(1, sizeof *block);
    for (size_t i = 0; i < count; i++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        struct cost key = {.address = (uint32_t)qemu_plugin_insn_vaddr(insn)};
        const struct cost *cost = bsearch(&key, costs, known, sizeof key, by_address);
        if (!cost) {
            fprintf(stderr, "no cycles are known of the instruction at %#x\n", key.address);
            abort();
        }
        if (i == 0) block->address = cost->address;
        block->least += cost->least;
        block->most += cost->most;
        block->branch = cost->taken_most ? cost : NULL;
        qemu_plugin_register_vcpu_mem_cb(insn, access_memory, NO_REGISTERS, MEMORY_READ_AND_WRITE, NULL);
        /* A call of semihosting takes nothing itself. */
        if (cost->most == 0) qemu_plugin_register_vcpu_insn_exec_cb(insn, tell, NO_REGISTERS, NULL);
    }
    qemu_plugin_register_vcpu_tb_exec_cb(tb, run, NO_REGISTERS, block);
}

static const char *value(const char *argument, const char *name) {
    size_t length = strlen(name);
    return strncmp(argument, name, length) == 0 ? argument + length : NULL;
}

EXPORTED int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv) {
    (void)info;
    FILE *table = NULL;
    for (int i = 0; i < argc; i++) {
        const char *path;
        if ((path = value(argv[i], "table="))) table = fopen(path, "r");
        if ((path = value(argv[i], "cycles="))) sums = open(path, O_RDWR | O_CREAT | O_TRUNC, 0666);
    }
    if (!table || sums < 0) return 1;
    struct cost cost;
    while (fscanf(table, "%x %x %u %u %u %u", &cost.address, &cost.next, &cost.least, &cost.most,
                  &cost.taken_least, &cost.taken_most) == 6) {
        if (known % 4096 == 0) costs = realloc(costs, (known + 4096) * sizeof cost);
        if (!costs) return 1;
        costs[known++] = cost;
    }
    fclose(table);
    qsort(costs, known, sizeof *costs, by_address);
    tell(0, NULL);
    qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
    return 0;
}
