/* Tests files of tallies: sums are read as written, damaged files are refused, chains of
 * checkpoints cover a shard once, and sums that do not go together are not added up. */
#include "base/file.h"
#include "base/system/file_system.h"
#include "claims.h"
#include "clean_folder.h"
#include "trace/checkpoint.h"

#define SUMS 18

static const char *overrides[] = {"injection.seed=7", ""};
static const struct scene_source source = {
    .path = "scene.yaml", .text = "sonject: 1\n", .overrides = overrides, .override_count = 2};
static const int64_t sums[SUMS] = {0, 0, 5, 0,         0,         0, 0, -7, 0,
                                   0, 0, 0, INT64_MAX, INT64_MIN, 1, 0, 0,  3};

/* Returns the head for a part of a shard that one process traced. */
static struct sums_head head_of(uint64_t shard, uint64_t shards, uint64_t first, uint64_t last,
                                uint64_t is_last)
{
    struct sums_head head;
    memset(&head, 0, sizeof head);
    strcpy(head.identity.version, "1.2");
    strcpy(head.identity.code, "code");
    strcpy(head.identity.scene, "scene");
    strcpy(head.launches, "course");
    head.shard = shard;
    head.shards = shards;
    head.first = first;
    head.last = last;
    head.is_last = is_last;
    head.rays = 100 + first;
    return head;
}

static void write_sums(const char *place, struct sums_head head, const int64_t *values,
                       size_t count)
{
    struct sums_writer writer;
    EXPECT_OK(&report, sums_writer_begin(&writer, &report, NULL, place));
    EXPECT_OK(&report, sums_writer_add_all(&writer, values, count));
    EXPECT_OK(&report, sums_writer_add_all(&writer, sums, SUMS));
    EXPECT_OK(&report, sums_writer_publish(&writer, &head, &source));
    sums_writer_clear(&writer);
}

struct collected {
    int64_t *values;
    uint64_t runs;
};

static bool collect(void *user, uint64_t first, const int64_t *values, size_t count)
{
    struct collected *all = user;
    memcpy(all->values + first, values, count * sizeof *values);
    all->runs++;
    return true;
}

static bool refuse_all(void *user, uint64_t first, const int64_t *values, size_t count)
{
    (void)user;
    (void)first;
    (void)values;
    (void)count;
    return false;
}

static void expect_sums(const struct sums_file *file, uint64_t record, const int64_t *values,
                        size_t count, uint64_t runs)
{
    struct collected all = {zeroed(count, sizeof(int64_t)), 0};
    EXPECT_OK(&report, sums_file_runs(file, &report, record, count, collect, &all));
    assert_memory_equal(all.values, values, count * sizeof *values);
    assert_int_equal(all.runs, runs);
    free(all.values);
}

CLEAN(test_what_is_written_is_read)
{
    struct sums_file file;
    struct sums_head head = head_of(2, 3, 4, 9, 1);
    /* too many to stay in memory */
    const size_t many = ((size_t)33 << 20) / sizeof(int64_t);
    int64_t *values = zeroed(many, sizeof *values);
    for (size_t i = 0; i < many; i++)
        values[i] = (int64_t)i * 7 - 5;
    write_sums(folder->path, head, values, many);
    assert_int_equal(count_entries(folder->path), 1);
    const char *path = file_in("shard-2-of-3-4-9.sums");
    EXPECT_OK(&report, sums_file_open(&file, &report, path));
    head.records = 2;
    assert_memory_equal(&file.head, &head, sizeof head);
    assert_string_equal(file.scene.path, source.path);
    assert_string_equal(file.scene.text, source.text);
    assert_true(path_is_absolute(file.scene.folder));
    assert_int_equal(file.scene.override_count, 2);
    for (size_t i = 0; i < 2; i++)
        assert_string_equal(file.scene.overrides[i], overrides[i]);
    expect_sums(&file, 0, values, many, 1);
    /* runs of 5; of -7; of the three at the limits, with the 3 behind two zeros */
    expect_sums(&file, 1, sums, SUMS, 3);
    /* a record that is not there, another number of sums, and a taker that refuses the sums */
    struct collected none = {NULL, 0};
    assert_int_equal(sums_file_runs(&file, &report, 2, SUMS, collect, &none), SONJECT_ERROR_INPUT);
    assert_int_equal(sums_file_runs(&file, &report, 1, SUMS + 1, collect, &none),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(sums_file_runs(&file, &report, 1, SUMS, refuse_all, NULL),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(none.runs, 0);
    /* the file is damaged after it was opened */
    write_bytes(path, sums, sizeof sums);
    assert_int_equal(sums_file_runs(&file, &report, 1, SUMS, collect, &none), SONJECT_ERROR_INPUT);
    sums_file_close(&file);
    free(values);
}

static void expect_refused(const char *path, const unsigned char *bytes, size_t count)
{
    struct sums_file file;
    write_bytes(path, bytes, count);
    report.message[0] = '\0';
    assert_int_equal(sums_file_open(&file, &report, path), SONJECT_ERROR_INPUT);
    assert_true(strstr(report.message, "damaged, or cut short") ||
                (count >= SUMS_MAGIC_BYTES && memcmp(bytes, SUMS_MAGIC, SUMS_MAGIC_BYTES) != 0 &&
                 strstr(report.message, "not sums as this version")));
}

CLEAN(test_no_damage_goes_unseen)
{
    struct sums_file file;
    size_t count;
    write_sums(folder->path, head_of(1, 1, 0, 9, 1), sums, SUMS);
    unsigned char *bytes = bytes_of_file(file_in("shard-1-of-1-0-9.sums"), &count);
    const char *path = file_in("damaged.sums");
    for (size_t i = 0; i < count; i++) {
        bytes[i] ^= (unsigned char)(1 << i % 8);
        expect_refused(path, bytes, count);
        bytes[i] ^= (unsigned char)(1 << i % 8);
        expect_refused(path, bytes, i);
    }
    bytes[count] = 0;
    expect_refused(path, bytes, count + 1);
    write_bytes(path, bytes, count);
    EXPECT_OK(&report, sums_file_open(&file, &report, path));
    sums_file_close(&file);
    free(bytes);
    /* a missing file and a folder are not damaged */
    assert_int_equal(sums_file_open(&file, &report, file_in("none.sums")), SONJECT_ERROR_STORAGE);
    assert_int_equal(sums_file_open(&file, &report, folder->path), SONJECT_ERROR_STORAGE);
}

/* A file that is made of blocks one by one, all with sound digests. */
struct draft {
    unsigned char bytes[4096];
    size_t count;
};

static void begin_draft(struct draft *draft)
{
    draft->count = SUMS_MAGIC_BYTES;
    memcpy(draft->bytes, SUMS_MAGIC, SUMS_MAGIC_BYTES);
}

static void add_block(struct draft *draft, uint64_t kind, const void *content, size_t count)
{
    struct block_head head;
    memset(&head, 0, sizeof head);
    head.kind = kind;
    head.bytes = count;
    assert_true(block_digest(&head, content));
    memcpy(draft->bytes + draft->count, &head, sizeof head);
    memcpy(draft->bytes + draft->count + sizeof head, content, count);
    draft->count += sizeof head + count;
}

static void expect_draft_refused(const char *path, const struct draft *draft)
{
    expect_refused(path, draft->bytes, draft->count);
}

/* Returns a head alone, without sums. */
static struct draft draft_of(struct sums_head head)
{
    struct draft draft;
    begin_draft(&draft);
    add_block(&draft, BLOCK_HEAD, &head, sizeof head);
    return draft;
}

CLEAN(test_what_makes_no_sense_is_refused)
{
    const char *path = file_in("draft.sums");
    const struct sums_head sound = head_of(1, 1, 0, 9, 1);
    struct sums_head heads[] = {head_of(0, 1, 0, 9, 1),
                                head_of(2, 1, 0, 9, 1),
                                head_of(1, 1, 9, 0, 1),
                                head_of(1, 1, 0, 9, 2),
                                sound,
                                sound,
                                sound};
    struct sums_file file;
    struct draft draft = draft_of(sound);
    write_bytes(path, draft.bytes, draft.count);
    EXPECT_OK(&report, sums_file_open(&file, &report, path));
    assert_null(file.scene.text);
    sums_file_close(&file);

    memset(heads[4].identity.scene, 'x', sizeof heads[4].identity.scene);
    memset(heads[5].launches, 'x', sizeof heads[5].launches);
    heads[6].records = 1;
    for (size_t i = 0; i < COUNT(heads); i++) {
        draft = draft_of(heads[i]);
        expect_draft_refused(path, &draft);
    }
    draft = draft_of(sound); /* two heads */
    add_block(&draft, BLOCK_HEAD, &sound, sizeof sound);
    expect_draft_refused(path, &draft);
    begin_draft(&draft); /* an unknown block */
    add_block(&draft, 4, sums, sizeof sums);
    add_block(&draft, BLOCK_HEAD, &sound, sizeof sound);
    expect_draft_refused(path, &draft);
    begin_draft(&draft); /* no head */
    add_block(&draft, BLOCK_SUMS, sums, sizeof sums);
    expect_draft_refused(path, &draft);
    /* a source that does not end, and one that is not whole */
    static const char *const sources[] = {"x", "scene.yaml\0/home\0"};
    static const size_t sizes[] = {1, 17};
    for (size_t i = 0; i < COUNT(sources); i++) {
        unsigned char content[sizeof sound + 17];
        memcpy(content, &sound, sizeof sound);
        memcpy(content + sizeof sound, sources[i], sizes[i]);
        begin_draft(&draft);
        add_block(&draft, BLOCK_HEAD, content, sizeof sound + sizes[i]);
        expect_draft_refused(path, &draft);
    }
}

CLEAN(test_runs_stay_within_their_sums)
{
    const char *path = file_in("draft.sums");
    /* number of sums; first and length of a run; values */
    static const uint64_t blocks[][5] = {{4, 2, 2, 8, 9},          {4, 3, 2, 8, 9},
                                         {4, 5, 0, 8, 9},          {4, 0, 3, 8, 9},
                                         {4, UINT64_MAX, 2, 8, 9}, {4, 1, UINT64_MAX, 8, 9}};
    struct sums_head head = head_of(1, 1, 0, 9, 1);
    head.records = 1;
    for (size_t i = 0; i < COUNT(blocks); i++) {
        int64_t found[4] = {0, 0, 0, 0};
        struct collected all = {found, 0};
        struct sums_file file;
        struct draft draft;
        begin_draft(&draft);
        add_block(&draft, BLOCK_SUMS, blocks[i], sizeof blocks[i]);
        add_block(&draft, BLOCK_HEAD, &head, sizeof head);
        write_bytes(path, draft.bytes, draft.count);
        EXPECT_OK(&report, sums_file_open(&file, &report, path));
        assert_int_equal(sums_file_runs(&file, &report, 0, 4, collect, &all),
                         i == 0 ? SONJECT_OK : SONJECT_ERROR_INPUT);
        assert_int_equal(all.runs, i == 0);
        sums_file_close(&file);
    }
}

struct span_of_file {
    uint64_t first, last;
    bool is_last;
};

struct chain_case {
    struct span_of_file files[6];
    size_t count;
    uint64_t next;
    size_t in_chain;
    bool is_complete;
};

CLEAN(test_chains_cover_a_shard_once)
{
    static const struct chain_case cases[] = {
        {{{0, 0, false}}, 0, 0, 0, false},
        {{{0, 4, false}, {4, 9, false}}, 2, 9, 2, false},
        {{{0, 4, false}, {5, 9, true}}, 2, 4, 1, false},
        {{{4, 9, true}}, 1, 0, 0, false},
        {{{0, 4, false}, {0, 6, false}, {4, 9, true}, {6, 8, false}}, 4, 9, 2, true},
        {{{0, 4, false}, {4, 7, false}, {0, 12, false}}, 3, 12, 1, false},
        /* in the order of names 100 comes before 20 */
        {{{0, 10, false}, {10, 20, false}, {20, 100, false}, {100, 200, false}, {200, 200, true}},
         5,
         200,
         5,
         true},
        {{{0, 0, true}}, 1, 0, 1, true}, /* a shard without strips */
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct sums_folder all;
        struct sums_chain chain;
        const char *path = file_in("work");
        EXPECT_OK(&report, folder_make(&report, path));
        for (size_t k = 0; k < cases[i].count; k++) {
            const struct span_of_file *file = &cases[i].files[k];
            write_sums(path, head_of(2, 3, file->first, file->last, file->is_last), sums, SUMS);
        }
        write_sums(path, head_of(1, 3, 0, 99, true), sums, SUMS); /* another shard's */
        EXPECT_OK(&report, sums_folder_read(&all, &report, path, 0, SIZE_MAX, false));
        assert_int_equal(all.count, cases[i].count + 1);
        EXPECT_OK(&report, sums_chain_find(&chain, &report, &all, 2));
        assert_int_equal(chain.next, cases[i].next);
        assert_int_equal(chain.count, cases[i].in_chain);
        assert_int_equal(chain.is_complete, cases[i].is_complete);
        for (size_t k = 0; k < chain.count; k++)
            assert_int_equal(chain.files[k]->head.first,
                             k + 1 < chain.count ? chain.files[k + 1]->head.last : 0);
        free(chain.files);
        sums_folder_clear(&all);
        sums_folder_remove(path);
        assert_false(file_exists(path));
    }
}

static void expect_folder(const char *path, uint64_t shard, size_t most, bool drops_damaged,
                          sonject_status status, size_t count)
{
    struct sums_folder all;
    assert_int_equal(sums_folder_read(&all, &report, path, shard, most, drops_damaged), status);
    assert_int_equal(all.count, count);
    if (shard > 0 && status == SONJECT_OK)
        assert_int_equal(all.files[0].head.shard, shard);
    sums_folder_clear(&all);
}

CLEAN(test_a_folder_gives_what_is_its_own)
{
    uint64_t shards = 7;
    const char *damaged = file_in("shard-1-of-3-4-5.sums");
    const char *other = file_in("shard-2-of-3-4-5.sums");
    expect_folder(file_in("none"), 0, SIZE_MAX, false, SONJECT_OK, 0);
    write_sums(folder->path, head_of(2, 3, 0, 4, false), sums, SUMS);
    write_sums(folder->path, head_of(1, 3, 0, 4, false), sums, SUMS);
    write_bytes(damaged, sums, sizeof sums);
    write_bytes(file_in("shard.sums.7-00.part.sums"), sums, sizeof sums);
    expect_folder(folder->path, 0, 1, false, SONJECT_OK, 1);
    EXPECT_OK(&report, sums_folder_shards(&report, folder->path, 3, &shards));
    assert_int_equal(shards, 0);
    EXPECT_OK(&report, sums_folder_shards(&report, folder->path, 1, &shards));
    assert_int_equal(shards, 3);
    /* a damaged file is refused; its own shard may drop it */
    expect_folder(folder->path, 0, SIZE_MAX, false, SONJECT_ERROR_INPUT, 1);
    expect_folder(folder->path, 2, SIZE_MAX, true, SONJECT_OK, 1);
    assert_true(file_exists(damaged));
    expect_folder(folder->path, 1, SIZE_MAX, true, SONJECT_OK, 1);
    assert_false(file_exists(damaged));
    /* another shard's file is sound, and stays */
    write_sums(folder->path, head_of(2, 3, 4, 5, true), sums, SUMS);
    assert_int_equal(rename(other, damaged), 0);
    expect_folder(folder->path, 1, SIZE_MAX, true, SONJECT_ERROR_INPUT, 2);
    assert_non_null(strstr(report.message, "another shard's"));
    assert_true(file_exists(damaged));
}

/* Adds up two checkpoints of two shards each. */
static sonject_status add_both(int64_t *total)
{
    struct sums_folder all;
    struct checkpoint checkpoint;
    struct trace_counts counts;
    const int64_t *added;
    memset(&counts, 0, sizeof counts);
    EXPECT_OK(&report, sums_folder_read(&all, &report, folder->path, 0, SIZE_MAX, false));
    assert_int_equal(all.count, 2);
    const struct sums_file *files[] = {&all.files[0], &all.files[1]};
    EXPECT_OK(&report, checkpoint_begin_adding(&checkpoint, &report, files, 2));
    sonject_status status = checkpoint_sums(&checkpoint, NULL, 2, &added);
    if (status == SONJECT_OK) {
        memcpy(total, added, 2 * sizeof *total);
        status = checkpoint_sums(&checkpoint, NULL, SUMS, &added);
    }
    THEN(status, checkpoint_finish(&checkpoint, &counts));
    checkpoint_clear(&checkpoint);
    sums_folder_clear(&all);
    return status;
}

CLEAN(test_only_what_goes_together_is_added_up)
{
    static const int64_t first[] = {3, INT64_MAX - 5};
    static const int64_t second[] = {-8, 5};
    static const int64_t overflows[] = {-8, 6};
    int64_t total[2] = {0, 0};
    /* both also hold `sums`, whose limits go beyond 64 bits when doubled */
    write_sums(folder->path, head_of(1, 2, 0, 9, true), first, 2);
    write_sums(folder->path, head_of(2, 2, 0, 9, true), second, 2);
    assert_int_equal(add_both(total), SONJECT_ERROR_INPUT);
    assert_int_equal(total[0], -5);
    assert_int_equal(total[1], INT64_MAX);
    write_sums(folder->path, head_of(2, 2, 0, 9, true), overflows, 2);
    total[0] = 0;
    assert_int_equal(add_both(total), SONJECT_ERROR_INPUT);
    assert_int_equal(total[0], 0);
    /* the course is that of other launches; this checkpoint's own has none at all */
    struct checkpoint checkpoint;
    struct trace_counts counts;
    struct sums_file file;
    memset(&counts, 0, sizeof counts);
    EXPECT_OK(&report, sums_file_open(&file, &report, file_in("shard-1-of-2-0-9.sums")));
    const struct sums_file *files[] = {&file};
    EXPECT_OK(&report, checkpoint_begin_adding(&checkpoint, &report, files, 1));
    checkpoint.record = 2;
    assert_int_equal(checkpoint_finish(&checkpoint, &counts), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "traced with other rays"));
    checkpoint_clear(&checkpoint);
    /* the course fits, but not all sums are taken */
    struct hash *hash = hash_begin();
    char nothing[HASH_TEXT_CAPACITY];
    assert_non_null(hash);
    hash_end(hash, nothing);
    strcpy(file.head.launches, nothing);
    EXPECT_OK(&report, checkpoint_begin_adding(&checkpoint, &report, files, 1));
    assert_int_equal(checkpoint_finish(&checkpoint, &counts), SONJECT_ERROR_INPUT);
    checkpoint_clear(&checkpoint);
    EXPECT_OK(&report, checkpoint_begin_adding(&checkpoint, &report, files, 1));
    checkpoint.record = 2;
    EXPECT_OK(&report, checkpoint_finish(&checkpoint, &counts));
    assert_int_equal(counts.rays, 100);
    checkpoint_clear(&checkpoint);
    sums_file_close(&file);
}

TEST_PROGRAM(NULL, NULL)
