#include "base/system/file_system.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>

#include <windows.h>

#include "base/system/windows_text.h"

#define SHARES_ALL      (FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE)
#define EPOCH_S         INT64_C(11644473600) /* 1970 on Windows' clock, s */
#define REPLACE_TRIES   20
#define REPLACE_WAIT_MS 50

/* Opens a file or folder. Returns INVALID_HANDLE_VALUE with errno on failure. */
static HANDLE open_handle(const char *path, DWORD access)
{
    wchar_t *name = wide_text(path);
    HANDLE handle = INVALID_HANDLE_VALUE;
    if (!name)
        return handle;
    handle = CreateFileW(name, access, SHARES_ALL, NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS,
                         NULL);
    errno = handle == INVALID_HANDLE_VALUE ? last_errno() : 0;
    free(name);
    return handle;
}

/* Returns 0 or an errno. */
static int read_facts(HANDLE handle, struct path_facts *facts)
{
    BY_HANDLE_FILE_INFORMATION found;
    memset(facts, 0, sizeof *facts);
    facts->kind = PATH_IS_DEVICE;
    if (GetFileType(handle) != FILE_TYPE_DISK)
        return 0;
    if (!GetFileInformationByHandle(handle, &found))
        return last_errno();
    const uint64_t changed = ((uint64_t)found.ftLastWriteTime.dwHighDateTime << 32) |
                             found.ftLastWriteTime.dwLowDateTime; /* in tenths of microseconds */
    facts->kind = found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY ? PATH_IS_FOLDER : PATH_IS_FILE;
    facts->device = found.dwVolumeSerialNumber;
    facts->number = ((uint64_t)found.nFileIndexHigh << 32) | found.nFileIndexLow;
    facts->bytes = ((uint64_t)found.nFileSizeHigh << 32) | found.nFileSizeLow;
    facts->changed_s = (int64_t)(changed / 10000000) - EPOCH_S;
    facts->changed_ns = (int64_t)(changed % 10000000) * 100;
    return 0;
}

int path_facts_read(const char *path, struct path_facts *facts)
{
    HANDLE handle = open_handle(path, FILE_READ_ATTRIBUTES);
    if (handle == INVALID_HANDLE_VALUE)
        return errno;
    const int error = read_facts(handle, facts);
    CloseHandle(handle);
    return error;
}

bool file_exists(const char *path)
{
    wchar_t *name = wide_text(path);
    const bool is_there = name && GetFileAttributesW(name) != INVALID_FILE_ATTRIBUTES;
    free(name);
    return is_there;
}

void descriptor_lead_nowhere(int descriptor)
{
    const int nowhere = _open("NUL", _O_RDWR | _O_NOINHERIT);
    if (nowhere < 0)
        return;
    _dup2(nowhere, descriptor);
    _close(nowhere);
}

FILE *file_open(const char *path, const char *mode)
{
    wchar_t *name = wide_text(path);
    wchar_t wide_mode[8] = {0};
    size_t length = strlen(mode);
    for (size_t i = 0; i < length && i < 6; i++)
        wide_mode[i] = (wchar_t)mode[i];
    wide_mode[length] = L'N'; /* not inherited */
    FILE *file = name ? _wfopen(name, wide_mode) : NULL;
    free(name);
    return file;
}

FILE *byte_file_open(const char *path, uint64_t *bytes)
{
    struct path_facts facts;
    HANDLE handle = open_handle(path, GENERIC_READ);
    if (handle == INVALID_HANDLE_VALUE)
        return NULL;
    int error = read_facts(handle, &facts);
    if (error == 0 && facts.kind != PATH_IS_FILE)
        error = facts.kind == PATH_IS_FOLDER ? EISDIR : ESPIPE;
    *bytes = facts.bytes;
    const int descriptor =
        error == 0 ? _open_osfhandle((intptr_t)handle, _O_RDONLY | _O_BINARY | _O_NOINHERIT) : -1;
    FILE *file = descriptor >= 0 ? _fdopen(descriptor, "rb") : NULL;
    error = error == 0 && !file ? errno : error;
    if (!file && descriptor >= 0)
        _close(descriptor);
    else if (!file)
        CloseHandle(handle);
    errno = error;
    return file;
}

bool byte_file_seek(FILE *file, uint64_t place)
{
    return place <= INT64_MAX && _fseeki64(file, (int64_t)place, SEEK_SET) == 0;
}

uint64_t byte_file_place(FILE *file)
{
    return (uint64_t)_ftelli64(file);
}

static int flush_to_disk(const char *path)
{
    HANDLE handle = open_handle(path, GENERIC_WRITE);
    if (handle == INVALID_HANDLE_VALUE)
        return errno;
    const int error = FlushFileBuffers(handle) ? 0 : last_errno();
    CloseHandle(handle);
    return error;
}

/* Moves a file, with retries because virus scanners keep new files open for a moment. */
static int replace(const wchar_t *from, const wchar_t *to)
{
    int error = 0;
    for (int i = 0; i < REPLACE_TRIES; i++) {
        if (MoveFileExW(from, to, MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
            return 0;
        error = last_errno();
        if (error != EACCES)
            return error;
        Sleep(REPLACE_WAIT_MS);
    }
    return error;
}

int file_replace(const char *from, const char *to)
{
    int error = flush_to_disk(from);
    if (error != 0)
        return error;
    wchar_t *part = wide_text(from);
    wchar_t *place = part ? wide_text(to) : NULL;
    error = place ? replace(part, place) : errno;
    free(part);
    free(place);
    return error;
}

void file_discard(const char *path)
{
    const int kept = errno;
    wchar_t *name = wide_text(path);
    if (name)
        DeleteFileW(name);
    free(name);
    errno = kept;
}

int folder_make_one(const char *path)
{
    struct path_facts facts;
    wchar_t *name = wide_text(path);
    if (!name)
        return errno;
    const int error = CreateDirectoryW(name, NULL) ? 0 : last_errno();
    free(name);
    if (error == 0 || path_facts_read(path, &facts) != 0)
        return error;
    return facts.kind == PATH_IS_FOLDER ? 0 : ENOTDIR;
}

void folder_discard(const char *path)
{
    wchar_t *name = wide_text(path);
    if (name)
        RemoveDirectoryW(name);
    free(name);
}

/* Returns the pattern by which FindFirstFileW lists a folder, for free(); NULL with errno. */
static wchar_t *all_within(const char *path)
{
    const size_t length = strlen(path);
    char *all = malloc(length + 3);
    if (!all)
        return NULL;
    memcpy(all, path, length);
    memcpy(all + length, "/*", 3);
    wchar_t *wide = wide_text(all);
    free(all);
    return wide;
}

int folder_hear_names(const char *path, bool (*hear)(void *user, const char *name), void *user)
{
    WIN32_FIND_DATAW entry;
    wchar_t *all = all_within(path);
    HANDLE search = all ? FindFirstFileW(all, &entry) : INVALID_HANDLE_VALUE;
    int error = !all ? errno : search == INVALID_HANDLE_VALUE ? last_errno() : 0;
    free(all);
    if (search == INVALID_HANDLE_VALUE)
        return error;
    bool goes_on = true;
    do {
        char *name = narrow_text(entry.cFileName); /* NULL: not valid UTF-16, so not ours */
        if (name && strcmp(name, ".") != 0 && strcmp(name, "..") != 0)
            goes_on = hear(user, name);
        free(name);
    } while (goes_on && FindNextFileW(search, &entry));
    error = goes_on && GetLastError() != ERROR_NO_MORE_FILES ? last_errno() : 0;
    FindClose(search);
    return error;
}

char *working_folder(void)
{
    wchar_t *wide = _wgetcwd(NULL, 0);
    char *folder = wide ? narrow_text(wide) : NULL;
    free(wide);
    return folder;
}

bool is_divider(char character)
{
    return character == '/' || character == '\\';
}

bool path_is_absolute(const char *path)
{
    const bool has_letter =
        (path[0] >= 'a' && path[0] <= 'z') || (path[0] >= 'A' && path[0] <= 'Z');
    return is_divider(path[0]) || (has_letter && path[1] == ':');
}

bool error_is_of_disk(int error)
{
    return error == EIO;
}

void error_text(int error, char *text, size_t capacity)
{
    if (strerror_s(text, capacity, error) != 0)
        snprintf(text, capacity, "error %d", error);
}
