/* Tests files that appear whole or not at all. */
#include "claims.h"

#include <fcntl.h>
#include <signal.h>
#ifdef HAS_POSIX
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#endif

#include "base/file.h"
#include "base/json_document.h"
#include "base/sha256.h"
#include "base/system/child.h"
#include "clean_folder.h"

static void expect_text(char *text, const char *expected)
{
    assert_non_null(text);
    assert_string_equal(text, expected);
    free(text);
}

TEST(test_paths)
{
    expect_text(path_join("folder", "name"), "folder/name");
    expect_text(path_join("folder/", "name"), "folder/name");
    expect_text(path_join("/", "name"), "/name");
    expect_text(path_join("", "name"), "name");
    expect_text(path_join("folder", "/name"), "/name");
    expect_text(path_folder("a/b/c"), "a/b");
    expect_text(path_folder("name"), "");
    expect_text(path_folder("/name"), "/");
    expect_text(path_folder("a/"), "a");
}

static void expect_part(const char *path, const char *extension)
{
    char *part = file_part_name(path);
    char end[64];
    snprintf(end, sizeof end, ".part%s", extension);
    assert_non_null(part);
    assert_memory_equal(part, path, strlen(path));
    assert_true(strlen(part) > strlen(path) + strlen(end));
    assert_string_equal(part + strlen(part) - strlen(end), end);
    free(part);
}

TEST(test_part_names_keep_the_extension_and_differ)
{
    char *names[64];
    expect_part("/a/image.tif", ".tif");
    expect_part("image.tar.gz", ".gz");
    expect_part("/a.b/image", "");
    expect_part("/a/.hidden", "");
    for (int i = 0; i < 64; i++) {
        names[i] = file_part_name("image.tif");
        assert_non_null(names[i]);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(names[i], names[j]);
    }
    for (int i = 0; i < 64; i++)
        free(names[i]);
}

CLEAN(test_a_file_is_written_and_read)
{
    const char *path = file_in("x.json");
    /* longer than what is read at once, and with a 0 in it */
    const size_t length = 200001;
    char *written = zeroed(length, 1);
    char *read;
    size_t count;
    for (size_t i = 0; i < length; i++)
        written[i] = (char)(i * 7 % 251);
    EXPECT_OK(&report, file_write_whole(&report, path, "old", 3));
    EXPECT_OK(&report, file_write_whole(&report, path, written, length));
    EXPECT_OK(&report, file_read_whole(&report, path, length, &read, &count));
    assert_int_equal(count, length);
    assert_memory_equal(read, written, length);
    assert_int_equal(read[length], 0);
    assert_int_equal(count_entries(folder->path), 1);
    free(read);
    free(written);
    EXPECT_OK(&report, file_write_whole(&report, path, "", 0));
    EXPECT_OK(&report, file_read_whole(&report, path, 0, &read, &count));
    assert_int_equal(count, 0);
    assert_int_equal(read[0], 0);
    free(read);
}

static void expect_message(const char *path, const char *reason)
{
    if (!strstr(report.message, path) || !strstr(report.message, reason))
        fail_msg("'%s' does not name '%s' and '%s'", report.message, path, reason);
}

CLEAN(test_what_cannot_be_read_or_written)
{
    char *read;
    size_t count;
    const char *path = file_in("x");
    assert_int_equal(file_read_whole(&report, path, 10, &read, &count), SONJECT_ERROR_STORAGE);
    expect_message(path, "No such file");
    assert_null(read);
    assert_int_equal(file_read_whole(&report, folder->path, 10, &read, &count),
                     SONJECT_ERROR_STORAGE);
    expect_message(folder->path, "directory");
    write_bytes(path, "12345678901", 11);
    assert_int_equal(file_read_whole(&report, path, 10, &read, &count), SONJECT_ERROR_INPUT);
    expect_message(path, "10 bytes");
    assert_null(read);
    path = file_in("missing/x");
    assert_int_equal(file_write_whole(&report, path, "1", 1), SONJECT_ERROR_STORAGE);
    expect_message(path, "No such file");
}

#ifdef HAS_POSIX
/* A limit on the size of files is as near as a test gets to a full disk. */
CLEAN(test_a_full_disk_leaves_the_old_file)
{
    static char many[100000];
    struct rlimit kept;
    struct rlimit low;
    const char *path = file_in("x");
    write_bytes(path, "old", 3);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    low = kept;
    low.rlim_cur = 4096;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
    const sonject_status status = file_write_whole(&report, path, many, sizeof many);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
    assert_int_equal(status, SONJECT_ERROR_STORAGE);
    expect_message(path, "File too large");
    assert_int_equal(count_entries(folder->path), 1);
    size_t count;
    unsigned char *bytes = bytes_of_file(path, &count);
    assert_int_equal(count, 3);
    assert_memory_equal(bytes, "old", 3);
    free(bytes);
}
#endif

CLEAN(test_publishing)
{
    const char *path = file_in("image.tif");
    char *part = file_part_name(path);
    write_bytes(part, "new", 3);
    assert_false(file_exists(path));
    EXPECT_OK(&report, file_publish(&report, part, path));
    assert_true(file_exists(path));
    assert_false(file_exists(part));
    /* a part that is not there, and a name that a folder has: the part is removed, and the message
     * names the file */
    assert_int_equal(file_publish(&report, part, path), SONJECT_ERROR_STORAGE);
    expect_message(path, "No such file");
    write_bytes(part, "new", 3);
    assert_int_equal(file_publish(&report, part, folder->path), SONJECT_ERROR_STORAGE);
    assert_false(file_exists(part));
    file_discard(part);
    free(part);
}

static const char *this_program;

static bool hear_part(void *part, const char *name)
{
    *(char **)part = strdup(name);
    return true;
}

/* Has this program, as a child, make a part, and waits for its end. Returns the part's path, for
 * free(). The folder must be empty. */
static char *orphaned_part(const char *path)
{
    struct child child = {0};
    char byte, *name = NULL;
    assert_int_equal(child_start(&child, this_program, path, UINT64_C(1) << 30, 10), 0);
    while (channel_receive(&child.channel, &byte, 1) != 0)
        continue;
    child_stop(&child);
    assert_int_equal(folder_hear_names(folder->path, hear_part, &name), 0);
    assert_non_null(name);
    char *part = path_join(folder->path, name);
    free(name);
    return part;
}

static int leave_part(const char *path)
{
    char *part = file_part_name(path);
    write_bytes(part, "", 0);
    free(part);
    return 0;
}

CLEAN(test_only_parts_of_dead_processes_are_tidied_away)
{
    const char *path = file_in("a.part.of.image.tif");
    char *orphan = orphaned_part(path);
    char *elsewhere = strdup(orphan); /* the same process number on another host */
    elsewhere[strlen(path) + 1] = elsewhere[strlen(path) + 1] == '0' ? '1' : '0';
    char *own = file_part_name(path);
    const char *kept[] = {own, path, elsewhere};
    assert_true(file_exists(orphan));
    for (size_t i = 0; i < COUNT(kept); i++)
        write_bytes(kept[i], "", 0);
    folder_tidy(folder->path);
    assert_false(file_exists(orphan));
    for (size_t i = 0; i < COUNT(kept); i++)
        assert_true(file_exists(kept[i]));
    free(own);
    free(elsewhere);
    free(orphan);
}

static bool holds(const json_t *entry, const char *path, bool hashes_all)
{
    bool is_same = false;
    EXPECT_OK(&report, file_entry_holds(&report, entry, path, hashes_all, &is_same));
    return is_same;
}

#ifdef HAS_POSIX
/* Changes the first byte of a file, and keeps the file's time if told to. */
static void alter(const char *path, bool keeps_time)
{
    struct stat facts;
    assert_int_equal(stat(path, &facts), 0);
    const struct timespec kept[2] = {facts.st_mtim, facts.st_mtim};
    const struct timespec later[2] = {{facts.st_mtim.tv_sec + 1, 0}, {facts.st_mtim.tv_sec + 1, 0}};
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    const int first = fgetc(file);
    rewind(file);
    fputc(first ^ 1, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(utimensat(AT_FDCWD, path, keeps_time ? kept : later, 0), 0);
}

CLEAN(test_files_below_16_mb_are_known_by_hash_others_by_size_and_time_too)
{
    const char *path = file_in("image.tif");
    const long sizes[] = {(16L << 20) - 1, 16L << 20};
    for (int i = 0; i < 2; i++) {
        const bool is_large = i == 1;
        json_t *entry;
        write_bytes(path, "", 0);
        assert_int_equal(truncate(path, sizes[i]), 0);
        EXPECT_OK(&report, file_entry(&report, path, "image.tif", true, &entry));
        alter(path, true);
        assert_int_equal(holds(entry, path, false), is_large);
        assert_false(holds(entry, path, true));
        alter(path, false);
        assert_true(holds(entry, path, false)); /* same bytes, but another time */
        alter(path, false);
        assert_false(holds(entry, path, false));
        assert_int_equal(truncate(path, sizes[i] - 1), 0);
        assert_false(holds(entry, path, false));
        assert_int_equal(unlink(path), 0);
        assert_false(holds(entry, path, false));
        json_decref(entry);
    }
}
#endif

CLEAN(test_a_list_of_files_reaches_nothing_outside_of_its_folder)
{
    char around[TEMPORARY_CAPACITY + 300];
    char absolute[TEMPORARY_CAPACITY + 300];
    snprintf(around, sizeof around, "..%s/kept", strrchr(folder->path, '/'));
    snprintf(absolute, sizeof absolute, "%s/kept", folder->path);
    const char *names[] = {around, absolute}; /* both lead to the file */
    for (size_t i = 0; i < COUNT(names); i++) {
        const char *path = file_in("kept");
        const char *changed = NULL;
        json_t *list = json_array();
        json_t *entry;
        write_bytes(path, "", 0);
        EXPECT_OK(&report, file_entry(&report, path, names[i], true, &entry));
        json_array_append_new(list, entry);
        EXPECT_OK(&report, file_list_check(list, &report, folder->path, true, &changed));
        assert_string_equal(changed, names[i]);
        file_list_discard(list, NULL, folder->path);
        assert_true(file_exists(file_in("kept")));
        json_decref(list);
    }
}

CLEAN(test_folders_are_made_with_their_parents)
{
    const char *path = file_in("a//b/c/");
    EXPECT_OK(&report, folder_make(&report, path));
    EXPECT_OK(&report, folder_make(&report, path));
    assert_true(file_exists(path));
    write_bytes(file_in("file"), "", 0);
    assert_int_equal(folder_make(&report, file_in("file")), SONJECT_ERROR_STORAGE);
    expect_message("file", "Not a directory");
    assert_int_equal(folder_make(&report, file_in("file/b")), SONJECT_ERROR_STORAGE);
    expect_message("file/b", "Not a directory");
}

/* Cases are the examples of FIPS 180-4, and lengths about a block's end, by another program. */
CLEAN(test_sha256_is_that_of_the_standard)
{
    static const struct {
        const char *text, *digest;
    } cases[] = {{"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
                 {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
                 {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                  "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
                 {"0123456789012345678901234567890123456789012345678901234",
                  "f34d5a0f80c0cbf84c8c0b90218c22637abd199965249da736a20143c8c9c9d9"},
                 {"0123456789012345678901234567890123456789012345678901234567890123",
                  "9674d9e078535b7cec43284387a6ee39956188e735a85452b0050b55341cda56"}};
    char digest[SHA256_TEXT_CAPACITY];
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *path = file_in("file");
        write_bytes(path, cases[i].text, strlen(cases[i].text));
        EXPECT_OK(&report, file_sha256(&report, path, digest));
        assert_string_equal(digest, cases[i].digest);
    }
    assert_int_equal(file_sha256(&report, file_in("absent"), digest), SONJECT_ERROR_STORAGE);
}

/* With a path, the program is the child of a test. */
int main(int count, char **arguments)
{
    this_program = arguments[0];
    return count > 1 ? leave_part(arguments[1]) : run_own_tests(NULL, NULL);
}
