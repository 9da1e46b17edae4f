// QEMU plugin: how often each translated block ran inside the measured frames.
//
// Arguments: out=FILE, begin=ADDRESS, end=ADDRESS of cairn_frame_begin and cairn_frame_end.
// Writes lines "F,frame,instructions" and "B,address,instructions,bytes,count in the worst frame,
// largest count in any frame".

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qemu_plugin.h"

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { kBuckets = 8192 };

struct Block {
  uint64_t address;
  uint64_t instructions;
  uint64_t bytes;
  uint64_t count;
  uint64_t count_at_begin;
  uint64_t in_worst_frame;
  uint64_t largest;
  struct Block* next;
};

static struct Block* blocks[kBuckets];
static uint64_t begin_address = 1;
static uint64_t end_address = 1;
static uint64_t instructions;
static uint64_t instructions_at_begin;
static uint64_t worst_frame;
static uint64_t* frames;
static size_t frame_count;
static bool inside;
static const char* out_path = "blocks.csv";

static void on_begin(unsigned cpu, void* data) {
  (void)cpu;
  (void)data;
  inside = true;
  instructions_at_begin = instructions;
  for (int i = 0; i < kBuckets; ++i) {
    for (struct Block* b = blocks[i]; b != NULL; b = b->next) b->count_at_begin = b->count;
  }
}

static void on_end(unsigned cpu, void* data) {
  (void)cpu;
  (void)data;
  if (!inside) return;
  inside = false;
  const uint64_t spent = instructions - instructions_at_begin;
  frames = realloc(frames, (frame_count + 1) * sizeof *frames);
  if (frames == NULL) abort();
  frames[frame_count++] = spent;
  const bool is_worst = spent > worst_frame;
  if (is_worst) worst_frame = spent;
  for (int i = 0; i < kBuckets; ++i) {
    for (struct Block* b = blocks[i]; b != NULL; b = b->next) {
      const uint64_t count = b->count - b->count_at_begin;
      if (is_worst) b->in_worst_frame = count;
      if (count > b->largest) b->largest = count;
    }
  }
}

static struct Block* find_block(const struct qemu_plugin_tb* tb) {
  const uint64_t address = qemu_plugin_tb_vaddr(tb) & ~1ULL;
  const uint64_t count = qemu_plugin_tb_n_insns(tb);
  struct Block** head = &blocks[(address >> 1U) % kBuckets];
  for (struct Block* b = *head; b != NULL; b = b->next) {
    if (b->address == address && b->instructions == count) return b;
  }
  struct Block* b = calloc(1, sizeof *b);
  if (b == NULL) abort();
  b->address = address;
  b->instructions = count;
  for (size_t i = 0; i < count; ++i)
    b->bytes += qemu_plugin_insn_size(qemu_plugin_tb_get_insn(tb, i));
  b->next = *head;
  *head = b;
  return b;
}

// Neither marker's own block is counted: the end is looked at before the counters, the begin after.
static void on_translate(qemu_plugin_id_t id, struct qemu_plugin_tb* tb) {
  (void)id;
  struct Block* b = find_block(tb);
  if (b->address == end_address) {
    qemu_plugin_register_vcpu_tb_exec_cb(tb, on_end, QEMU_PLUGIN_CB_NO_REGS, NULL);
  }
  qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &b->count, 1);
  qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &instructions,
                                           b->instructions);
  if (b->address == begin_address) {
    qemu_plugin_register_vcpu_tb_exec_cb(tb, on_begin, QEMU_PLUGIN_CB_NO_REGS, NULL);
  }
}

static void on_exit_write(qemu_plugin_id_t id, void* data) {
  (void)id;
  (void)data;
  FILE* file = fopen(out_path, "w");
  if (file == NULL) return;
  for (size_t i = 0; i < frame_count; ++i) {
    fprintf(file, "F,%zu,%llu\n", i, (unsigned long long)frames[i]);
  }
  for (int i = 0; i < kBuckets; ++i) {
    for (const struct Block* b = blocks[i]; b != NULL; b = b->next) {
      if (b->largest == 0) continue;
      fprintf(file, "B,0x%llx,%llu,%llu,%llu,%llu\n", (unsigned long long)b->address,
              (unsigned long long)b->instructions, (unsigned long long)b->bytes,
              (unsigned long long)b->in_worst_frame, (unsigned long long)b->largest);
    }
  }
  fclose(file);
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id,
                                                               const qemu_info_t* info, int argc,
                                                               char** argv) {
  (void)info;
  for (int i = 0; i < argc; ++i) {
    if (strncmp(argv[i], "out=", 4) == 0) {
      out_path = strdup(argv[i] + 4);
    } else if (strncmp(argv[i], "begin=", 6) == 0) {
      begin_address = strtoull(argv[i] + 6, NULL, 0) & ~1ULL;
    } else if (strncmp(argv[i], "end=", 4) == 0) {
      end_address = strtoull(argv[i] + 4, NULL, 0) & ~1ULL;
    } else {
      fprintf(stderr, "block_count: unknown argument %s\n", argv[i]);
      return -1;
    }
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, on_translate);
  qemu_plugin_register_atexit_cb(id, on_exit_write, NULL);
  return 0;
}
