/* Counts the instructions that QEMU executes: by context, room and address.
 *
 * A context is the code between the entry of an exception and its return; contexts nest as exceptions do. A room is a
 * part of the project; code outside of all rooms (division, memcpy) counts for the calling room. Both are followed
 * here, instruction by instruction, because a sum at the end would lose the callers.
 *
 * Arguments: map=FILE   the room of every half word, a byte each (0: the caller's room)
 *            out=FILE   takes the counts
 *            start=V    counting begins when the handler of vector V is entered for the first time
 *            handler=V:ADDRESS:PRIORITY   a handler, numbers in hexadecimal
 *            asked=V,answered=V,aside=V   work from a question to its answer, without that of the contexts aside
 *            split=V:W   counts the handler of V as W if nothing was asked since it was entered last
 *            line=ADDRESS, constant=ADDRESS   flash lines of a handler that takes the place of the step interrupt's in the
 *                        caches; steps=V names the step interrupt
 *            tell=PORT   a byte goes to this port of TCP whenever the handler that is split is done with a question
 *
 * The declarations are those of QEMU's plugin interface, version 1 (docs/devel/tcg-plugins in its sources).
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <arpa/inet.h>
#include <sys/socket.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef void tb_callback(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void insn_callback(unsigned, void *);
typedef void exit_callback(qemu_plugin_id_t, void *);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, tb_callback *);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, insn_callback *, int, void *);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, exit_callback *, void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn *);

#define EXPORT __attribute__((visibility("default")))
EXPORT int qemu_plugin_version = 1;

/* The F446's caches of flash lines, of instructions and of constants (RM0390 rev 6, 3.4.2), and lines that we can tell
 * apart. */
enum { LINE = 16, WAYS = 64, CONSTANT_WAYS = 8, LINES = (1 << 20) / LINE + 128 };

enum { VECTORS = 64, ROOMS = 16, DEPTH = 256, NESTED = 16, PLACES = 1 << 19 };
enum { PLAIN, CALL, RETURN };

struct cell { uint64_t count, taken; };

/* A cache: the least recently used line is replaced. */
struct cache {
    unsigned ways, now;
    unsigned lines[WAYS], used[WAYS];    /* a line's number and one, and when it was used last */
    uint8_t way[LINES];                  /* its way and one */
};

struct context {
    unsigned vector, depth;
    uint8_t rooms[DEPTH];    /* of the callers */
    uint32_t last;           /* the place executed last, */
    struct cell *cell;       /* and its count */
    uint64_t spent[ROOMS];   /* since it was entered */
};

static uint8_t map[PLACES], kind[PLACES], size[PLACES], handler[PLACES];
static uint8_t second[PLACES];    /* the handler whose second instruction it is */
static struct cell *cells[VECTORS][ROOMS];
static uint64_t entries[VECTORS], most[VECTORS][ROOMS], longest[VECTORS];
static unsigned priority[VECTORS];
static bool is_aside[VECTORS];
static struct context stack[NESTED];
static unsigned top;
static bool is_on, is_asked, is_heard;
static unsigned start, asked, answered, split, apart;
static uint64_t work, work_before, answers, answers_sum;
static const char *out;
static int listener = -1;
static struct cache code = { .ways = WAYS }, constants = { .ways = CONSTANT_WAYS };
static uint64_t missed[VECTORS][2];
static uint32_t constant[PLACES];        /* the line that an instruction's constant is in, and one */
static unsigned last_line, steps, path[2][WAYS], path_length[2];

static void fail(const char *why)
{
    fprintf(stderr, "bench: %s\n", why);
    exit(1);
}

/* A number for every half word of the first 512 KiB of flash and of RAM. */
static uint32_t place(uint64_t address)
{
    return (address >> 29 & 1) << 18 | (address & 0x7FFFF) >> 1;
}

static uint64_t address(uint32_t place)
{
    return (uint64_t)(place >> 18) << 29 | (uint64_t)(place & 0x3FFFF) << 1;
}

/* Whether a line has to be fetched. */
static bool misses(struct cache *c, unsigned line)
{
    unsigned way = c->way[line];
    bool is_missing = !way;
    if (is_missing) {
        unsigned oldest = 0;
        for (unsigned i = 1; i < c->ways; i++)
            if (c->used[i] < c->used[oldest])
                oldest = i;
        if (c->lines[oldest])
            c->way[c->lines[oldest] - 1] = 0;
        c->lines[oldest] = line + 1;
        c->way[line] = way = oldest + 1;
    }
    c->used[way - 1] = ++c->now;
    return is_missing;
}

/* An instruction is fetched, and its constant. */
static void fetch(uint32_t at, unsigned vector)
{
    unsigned line = at * 2 / LINE, next = (at + size[at] - 1) * 2 / LINE;
    if (steps && vector == steps)
        return;
    for (unsigned i = line; i <= next; i++)
        if (i != last_line)
            missed[vector][0] += misses(&code, i) && is_on;
    last_line = next;
    if (constant[at])
        missed[vector][1] += misses(&constants, constant[at] - 1) && is_on;
}

/* The other handler's lines are fetched. */
static void fetch_path(void)
{
    for (unsigned kind = 0; kind < 2; kind++)
        for (unsigned i = 0; i < path_length[kind]; i++)
            missed[steps][kind] += misses(kind ? &constants : &code, path[kind][i]) && is_on;
    last_line = LINES;
}

static void enter(unsigned vector)
{
    if (++top >= NESTED)
        fail("exceptions nest too deep");
    struct context *c = &stack[top];
    memset(c, 0, sizeof *c);
    if (vector == split) {
        vector = is_heard ? split : apart;
        is_heard = false;
    }
    c->vector = vector;
    is_on |= vector == start;
    is_heard |= vector == asked;
    if (steps && vector == steps)
        fetch_path();
    if (!is_on)
        return;
    entries[vector]++;
    if (vector == asked) {
        is_asked = true;
        work_before = work;
    } else if (vector == answered && is_asked) {
        is_asked = false;
        answers++;
        answers_sum += work - work_before;
    }
}

static void leave(void)
{
    struct context *c = &stack[top--];
    uint64_t sum = 0;
    for (unsigned room = 0; room < ROOMS; room++) {
        sum += c->spent[room];
        if (c->spent[room] > most[c->vector][room])
            most[c->vector][room] = c->spent[room];
    }
    if (sum > longest[c->vector])
        longest[c->vector] = sum;
    if (c->vector == split && listener >= 0)
        send(listener, "", 1, MSG_NOSIGNAL);
}

static bool is_leaving(const struct context *c)
{
    return c->depth == 0 && c->cell && kind[c->last] == RETURN;
}

/* The handler that begins here, if any. QEMU does not report a first instruction if the interrupt came while it
 * cut a block at an access to a device; then the second one is the begin. */
static unsigned begins(uint32_t to)
{
    const struct context *c = &stack[top];
    while (c > stack && is_leaving(c))
        c--;
    bool is_behind_first = c->cell && handler[c->last] && to == c->last + size[c->last];
    return second[to] && !is_behind_first ? second[to] : handler[to];
}

/* The effect of the previous instruction is known only now. */
static void arrive(uint32_t to)
{
    unsigned vector = begins(to);
    if (vector) {
        /* An exception that cannot interrupt the present context came after it. */
        while (top && is_leaving(&stack[top]) && priority[vector] >= priority[stack[top].vector])
            leave();
        enter(vector);
        return;
    }
    for (;;) {
        struct context *c = &stack[top];
        if (!c->cell || to == c->last + size[c->last])
            return;
        if (top && is_leaving(c)) {
            leave();
            continue;
        }
        c->cell->taken += is_on;
        if (kind[c->last] == CALL) {
            if (c->depth + 1 >= DEPTH)
                fail("calls nest too deep");
            uint8_t caller = map[c->last] ? map[c->last] : c->rooms[c->depth];
            c->rooms[++c->depth] = caller;
        } else if (kind[c->last] == RETURN && c->depth) {
            c->depth--;
        }
        return;
    }
}

static void execute(unsigned cpu, void *data)
{
    (void)cpu;
    uint32_t at = (uint32_t)(uintptr_t)data;
    arrive(at);
    struct context *c = &stack[top];
    unsigned room = map[at] ? map[at] : c->rooms[c->depth];
    struct cell **found = &cells[c->vector][room];
    if (!*found && !(*found = calloc(PLACES, sizeof **found)))
        fail("no memory");
    c->last = at;
    c->cell = *found + at;
    fetch(at, c->vector);
    if (is_on) {
        c->cell->count++;
        c->spent[room]++;
        work += !is_aside[c->vector];
    }
}

static uint8_t classify(uint16_t first, uint16_t second)
{
    bool is_call = (first & 0xF800) == 0xF000 && (second & 0xD000) == 0xD000;     /* BL */
    is_call |= (first & 0xFF87) == 0x4780;                                        /* BLX */
    bool is_return = first == 0x4770 || (first & 0xFF00) == 0xBD00;               /* BX LR, POP {.., PC} */
    is_return |= first == 0xE8BD && second & 0x8000;                              /* POP.W {.., PC} */
    is_return |= first == 0xF85D && second == 0xFB04;                             /* LDR PC, [SP], #4 */
    return is_call ? CALL : is_return ? RETURN : PLAIN;
}

/* Where the constant of a load lies that has it beside the code: LDR and VLDR of a literal. */
static uint32_t literal(uint32_t at, uint16_t first, uint16_t second)
{
    uint64_t base = (address(at) + 4) & ~3ull;
    int sign = first & 0x80 ? 1 : -1;
    if (first >> 11 == 9)
        return place(base + 4 * (first & 0xFF));
    if ((first & 0xFF7F) == 0xF85F)
        return place(base + sign * (second & 0xFFF));
    if ((first & 0xFF3F) == 0xED1F)
        return place(base + sign * 4 * (second & 0xFF));
    return PLACES;
}

static void translate(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    for (size_t i = 0; i < qemu_plugin_tb_n_insns(tb); i++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        uint32_t at = place(qemu_plugin_insn_vaddr(insn));
        uint16_t half[2] = { 0, 0 };
        size_t bytes = qemu_plugin_insn_size(insn);
        memcpy(half, qemu_plugin_insn_data(insn), bytes);
        kind[at] = classify(half[0], half[1]);
        size[at] = bytes / 2;
        uint32_t from = literal(at, half[0], half[1]);
        constant[at] = from < PLACES ? from * 2 / LINE + 1 : 0;
        if (handler[at])
            second[at + size[at]] = handler[at];
        qemu_plugin_register_vcpu_insn_exec_cb(insn, execute, 0, (void *)(uintptr_t)at);
    }
}

static void finish(qemu_plugin_id_t id, void *data)
{
    (void)id, (void)data;
    FILE *f = fopen(out, "w");
    if (!f)
        fail("cannot write the counts");
    fprintf(f, "answers %llu %llu\n", (unsigned long long)answers, (unsigned long long)answers_sum);
    for (unsigned v = 0; v < VECTORS; v++) {
        if (missed[v][0] || missed[v][1])
            fprintf(f, "missed %u %llu %llu\n", v, (unsigned long long)missed[v][0], (unsigned long long)missed[v][1]);
        if (entries[v])
            fprintf(f, "context %u %llu %llu\n", v, (unsigned long long)entries[v], (unsigned long long)longest[v]);
        for (unsigned r = 0; r < ROOMS; r++) {
            if (most[v][r])
                fprintf(f, "most %u %u %llu\n", v, r, (unsigned long long)most[v][r]);
            for (uint32_t p = 0; cells[v][r] && p < PLACES; p++) {
                const struct cell *c = &cells[v][r][p];
                if (c->count)
                    fprintf(f, "at %u %u %llu %llu %llu\n", v, r, (unsigned long long)address(p),
                            (unsigned long long)c->count, (unsigned long long)c->taken);
            }
        }
    }
    fclose(f);
}

static bool reach(const char *port)
{
    struct sockaddr_in to = { .sin_family = AF_INET, .sin_port = htons(atoi(port)) };
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    listener = socket(AF_INET, SOCK_STREAM, 0);
    return listener >= 0 && !connect(listener, (struct sockaddr *)&to, sizeof to);
}

/* One more line of the other handler; they are the last of those that we can tell apart. */
static bool take_line(unsigned kind)
{
    unsigned i = path_length[kind]++;
    path[kind][i % WAYS] = LINES - 1 - kind * WAYS - i;
    return i < WAYS;
}

static bool take(const char *argument)
{
    unsigned v, level;
    unsigned long at;
    if (!strncmp(argument, "map=", 4)) {
        FILE *f = fopen(argument + 4, "r");
        bool is_read = f && fread(map, 1, PLACES, f) == PLACES;
        return is_read && !fclose(f);
    }
    if (!strncmp(argument, "out=", 4))
        return (out = strdup(argument + 4));
    if (!strncmp(argument, "tell=", 5))
        return reach(argument + 5);
    if (sscanf(argument, "handler=%x:%lx:%x", &v, &at, &level) == 3 && v < VECTORS) {
        handler[place(at & ~1ul)] = v;
        priority[v] = level;
        return true;
    }
    if (sscanf(argument, "split=%x:%x", &split, &apart) == 2 && split < VECTORS && apart < VECTORS) {
        priority[apart] = priority[split];
        return true;
    }
    if (sscanf(argument, "aside=%x", &v) == 1 && v < VECTORS)
        return is_aside[v] = true;
    if (!strncmp(argument, "line=", 5))
        return take_line(0);
    if (!strncmp(argument, "constant=", 9))
        return take_line(1);
    return sscanf(argument, "start=%x", &start) == 1 || sscanf(argument, "steps=%x", &steps) == 1 || sscanf(argument, "asked=%x", &asked) == 1
        || sscanf(argument, "answered=%x", &answered) == 1;
}

EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int count, char **arguments)
{
    (void)info;
    for (int i = 0; i < count; i++)
        if (!take(arguments[i]))
            fail(arguments[i]);
    if (!out)
        fail("no place for the counts");
    qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
    qemu_plugin_register_atexit_cb(id, finish, NULL);
    return 0;
}
