#include "base/file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/system/process.h"

#define NAMES_MAX ((size_t)1 << 20) /* limit for a folder */

sonject_status input_failure(struct report *report, const char *path, const char *format, ...)
{
    char what[REPORT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, what);
}

sonject_status file_failure(struct report *report, const char *path, const char *action, int error)
{
    char reason[128];
    error_text(error, reason, sizeof reason);
    return report_failure(report, error == ENOMEM ? SONJECT_ERROR_MEMORY : SONJECT_ERROR_STORAGE,
                          "%s: cannot %s: %s", path, action, reason);
}

bool file_error_is_of_system(int error)
{
    return error_is_of_disk(error) || error == ENXIO || error == ENODEV || error == EMFILE ||
           error == ENFILE || error == ENOMEM;
}

static sonject_status refuse_endless(struct report *report, const char *path)
{
    return input_failure(report, path,
                         "is not a regular file but a pipe or a device: copy it to a file");
}

sonject_status file_refuse(struct report *report, const char *path, int error)
{
    if (error == ESPIPE)
        return refuse_endless(report, path);
    const sonject_status status = file_failure(report, path, "open", error);
    return file_error_is_of_system(error) ? status : SONJECT_ERROR_INPUT;
}

sonject_status file_check_disk(struct report *report, const char *path, sonject_status status)
{
    return status == SONJECT_ERROR_INPUT && error_is_of_disk(errno)
               ? file_failure(report, path, "read", errno)
               : status;
}

/* Returns the last character that divides a path into parts; NULL if there is none. */
static const char *last_divider(const char *path)
{
    const char *last = NULL;
    for (; *path; path++)
        last = is_divider(*path) ? path : last;
    return last;
}

/* Returns the end of the last component, from its last '.' on; "" if there is none. */
static const char *extension_of(const char *path)
{
    const char *name = path_name(path);
    const char *dot = strrchr(name, '.');
    return dot && dot != name ? dot : "";
}

char *file_part_name(const char *path)
{
    const char *extension = extension_of(path);
    const size_t capacity = strlen(path) + strlen(extension) + 64;
    char *part = allocate_array(capacity, 1);
    if (part)
        snprintf(part, capacity, "%s.%08" PRIx32 "-%ld-%016" PRIx64 ".part%s", path,
                 process_place(), process_number(), unique_number(), extension);
    return part;
}

/* Returns whether a name is that of a part, left by an ended process of this place. */
static bool is_orphan(const char *name)
{
    for (const char *dot = strchr(name, '.'); dot; dot = strchr(dot + 1, '.')) {
        uint32_t place;
        long process;
        uint64_t unique;
        int end = 0;
        if (sscanf(dot, ".%8" SCNx32 "-%ld-%16" SCNx64 ".part%n", &place, &process, &unique,
                   &end) == 3 &&
            end > 0 && (dot[end] == '.' || dot[end] == '\0'))
            return place == process_place() && process > 0 && process_has_ended(process);
    }
    return false;
}

/* user: the folder's path. */
static bool tidy_name(void *user, const char *name)
{
    char *path = is_orphan(name) ? path_join(user, name) : NULL;
    if (path)
        file_discard(path);
    free(path);
    return true;
}

void folder_tidy(const char *path)
{
    (void)folder_hear_names(path, tidy_name, (void *)path);
}

void file_protect(struct report *report, const char *path)
{
    struct path_facts facts;
    if (path_facts_read(path, &facts) != 0)
        return;
    const size_t place = report->input_count++ % INPUTS_KEPT;
    report->inputs[place].device = facts.device;
    report->inputs[place].number = facts.number;
}

sonject_status file_check_replaced(struct report *report, const char *path)
{
    struct path_facts facts;
    if (path_facts_read(path, &facts) != 0)
        return SONJECT_OK;
    if (facts.kind == PATH_IS_DEVICE)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "%s: is a pipe or a device, and no file replaces it: choose another "
                              "name",
                              path);
    for (size_t i = 0; i < report->input_count && i < INPUTS_KEPT; i++)
        if (report->inputs[i].device == facts.device && report->inputs[i].number == facts.number)
            return report_failure(report, SONJECT_ERROR_ARGUMENT,
                                  "%s: is the image that was read, and no result replaces it: "
                                  "choose another name or folder",
                                  path);
    return SONJECT_OK;
}

sonject_status file_publish(struct report *report, const char *part, const char *path)
{
    const sonject_status status = file_check_replaced(report, path);
    if (status != SONJECT_OK) {
        file_discard(part);
        return status;
    }
    const int error = file_replace(part, path);
    if (error == 0)
        return SONJECT_OK;
    file_discard(part);
    return file_failure(report, path, "write", error);
}

sonject_status file_write_parts(struct report *report, const char *path, const void *head,
                                size_t head_bytes, const void *bytes, size_t count)
{
    char *part = file_part_name(path);
    CHECK_MEMORY(report, part, "a file name");
    errno = 0;
    FILE *file = file_open(part, "wb");
    bool is_written = file && fwrite(head, 1, head_bytes, file) == head_bytes &&
                      fwrite(bytes, 1, count, file) == count;
    int error = errno;
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        error = errno;
    }
    if (!is_written)
        file_discard(part);
    const sonject_status status = is_written
                                      ? file_publish(report, part, path)
                                      : file_failure(report, path, "write", error ? error : EIO);
    free(part);
    return status;
}

sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count)
{
    return file_write_parts(report, path, "", 0, bytes, count);
}

sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count)
{
    uint64_t size = 0;
    *bytes = NULL;
    *count = 0;
    CHECK(file_note_read(report, path));
    FILE *file = byte_file_open(path, &size);
    if (!file)
        return errno == ESPIPE
                   ? refuse_endless(report, path)
                   : file_failure(report, path, errno == EISDIR ? "read" : "open", errno);
    sonject_status status = SONJECT_OK;
    if (size > limit)
        status = input_failure(report, path, "larger than %zu bytes", limit);
    else if (!(*bytes = allocate_array((size_t)size + 1, 1)))
        status = report_out_of_memory(report, path);
    else if ((*count = fread(*bytes, 1, (size_t)size, file)) < size && ferror(file))
        status = file_failure(report, path, "read", errno);
    fclose(file);
    if (status != SONJECT_OK) {
        free(*bytes);
        *bytes = NULL;
        *count = 0;
    }
    return status;
}

sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path)
{
    char *whole = growing_text_end(text);
    CHECK_MEMORY(report, whole, path);
    const sonject_status status = file_write_whole(report, path, whole, strlen(whole));
    free(whole);
    return status;
}

bool byte_file_read(FILE *file, uint64_t place, void *bytes, size_t count)
{
    return byte_file_seek(file, place) && fread(bytes, 1, count, file) == count;
}

bool byte_file_copy(FILE *from, uint64_t place, uint64_t count, FILE *to)
{
    unsigned char buffer[16384];
    if (!byte_file_seek(from, place))
        return false;
    while (count > 0) {
        const size_t some = count < sizeof buffer ? (size_t)count : sizeof buffer;
        if (fread(buffer, 1, some, from) != some || fwrite(buffer, 1, some, to) != some)
            return false;
        count -= some;
    }
    return true;
}

sonject_status folder_make(struct report *report, const char *path)
{
    char *name = copy_text(path);
    CHECK_MEMORY(report, name, "a folder's name");
    int error = 0;
    for (char *end = name; error == 0 && *end; end++) {
        if (!is_divider(*end) || end == name)
            continue;
        const char divider = *end;
        *end = '\0';
        error = folder_make_one(name);
        *end = divider;
    }
    if (error == 0)
        error = folder_make_one(name);
    free(name);
    return error == 0 ? SONJECT_OK : file_failure(report, path, "make the folder", error);
}

sonject_status file_identify(struct report *report, const char *path, struct path_facts *facts)
{
    const int error = path_facts_read(path, facts);
    if (error != 0)
        return file_failure(report, path, "open", error);
    if (facts->kind == PATH_IS_FOLDER)
        return file_failure(report, path, "read", EISDIR);
    return facts->kind == PATH_IS_FILE ? SONJECT_OK : refuse_endless(report, path);
}

sonject_status file_note_read(struct report *report, const char *path)
{
    struct read_files *reads = report->reads;
    struct path_facts facts;
    if (!reads || path_facts_read(path, &facts) != 0)
        return SONJECT_OK;
    for (size_t i = 0; i < reads->count; i++)
        if (strcmp(reads->files[i].path, path) == 0)
            return SONJECT_OK;
    struct read_file *files = grow_doubling(reads->files, reads->count, sizeof *files);
    CHECK_MEMORY(report, files, path);
    reads->files = files;
    files[reads->count] = (struct read_file){copy_text(path), facts};
    CHECK_MEMORY(report, files[reads->count].path, path);
    reads->count++;
    return SONJECT_OK;
}

void read_files_clear(struct read_files *reads)
{
    for (size_t i = 0; i < reads->count; i++)
        free(reads->files[i].path);
    free(reads->files);
    memset(reads, 0, sizeof *reads);
}

bool file_is_unchanged(const char *path, const struct path_facts *facts)
{
    struct path_facts now;
    return path_facts_read(path, &now) == 0 && now.bytes == facts->bytes &&
           now.changed_s == facts->changed_s && now.changed_ns == facts->changed_ns;
}

bool paths_are_same(const char *a, const char *b)
{
    struct path_facts one, other;
    return path_facts_read(*a ? a : ".", &one) == 0 && path_facts_read(*b ? b : ".", &other) == 0 &&
           one.device == other.device && one.number == other.number;
}

/* Returns the divider between a folder and a name: "" if the folder is "" or ends with one. */
static const char *divider_behind(const char *folder)
{
    const char *divider = last_divider(folder);
    return *folder == '\0' || (divider && divider[1] == '\0') ? "" : "/";
}

char *path_join(const char *folder, const char *name)
{
    if (path_is_absolute(name))
        return copy_text(name);
    const size_t capacity = strlen(folder) + strlen(name) + 2;
    char *path = allocate_array(capacity, 1);
    if (path)
        snprintf(path, capacity, "%s%s%s", folder, divider_behind(folder), name);
    return path;
}

sonject_status path_in(struct report *report, char path[PATH_CAPACITY], const char *folder,
                       const char *format, ...)
{
    char name[PATH_CAPACITY];
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(name, sizeof name, format, values);
    va_end(values);
    const char *where = path_is_absolute(name) ? "" : folder;
    const int whole = snprintf(path, PATH_CAPACITY, "%s%s%s", where, divider_behind(where), name);
    if (length < 0 || length >= PATH_CAPACITY || whole < 0 || whole >= PATH_CAPACITY)
        return file_failure(report, folder, "name a file below", ENAMETOOLONG);
    return SONJECT_OK;
}

char *path_absolute(const char *path)
{
    char *folder = path_is_absolute(path) ? NULL : working_folder();
    char *whole = path_join(folder ? folder : "", path);
    free(folder);
    return whole;
}

const char *path_name(const char *path)
{
    const char *divider = last_divider(path);
    return divider ? divider + 1 : path;
}

char *path_folder(const char *path)
{
    const char *divider = last_divider(path);
    char *folder = copy_text(path);
    if (folder && !divider)
        folder[0] = '\0';
    else if (folder)
        folder[divider == path ? 1 : divider - path] = '\0';
    return folder;
}

void folder_names_clear(struct folder_names *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    memset(list, 0, sizeof *list);
}

static bool add_name(struct folder_names *list, const char *name)
{
    char **more =
        list->count < NAMES_MAX ? grow_doubling(list->names, list->count, sizeof *more) : NULL;
    if (!more)
        return false;
    list->names = more;
    char *copy = copy_text(name);
    list->names[list->count] = copy;
    list->count += copy != NULL;
    return copy != NULL;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* A folder's names while they are listed. */
struct names_heard {
    struct folder_names *list;
    const char *prefix;
    bool is_out_of_memory;
};

static bool hear_name(void *user, const char *name)
{
    struct names_heard *heard = user;
    if (strncmp(name, heard->prefix, strlen(heard->prefix)) == 0)
        heard->is_out_of_memory = !add_name(heard->list, name);
    return !heard->is_out_of_memory;
}

sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix)
{
    struct names_heard heard = {list, prefix, false};
    memset(list, 0, sizeof *list);
    const int error = folder_hear_names(path, hear_name, &heard);
    sonject_status status = SONJECT_OK;
    if (heard.is_out_of_memory)
        status = report_out_of_memory(report, path);
    else if (error != 0 && error != ENOENT && error != ENOTDIR)
        status = file_failure(report, path, "read", error);
    if (status != SONJECT_OK)
        folder_names_clear(list);
    else if (list->count > 0)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}
