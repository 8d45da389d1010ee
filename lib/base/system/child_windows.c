#include "base/system/child.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <windows.h>

#include "base/system/process.h"
#include "base/system/windows_text.h"

#define PIPE_BYTES   ((DWORD)1 << 16)
#define MOVED_MAX    ((size_t)1 << 20) /* bytes per call */
#define STOP_WAIT_MS 50
#define CRASHES      0xC0000000u /* exit codes from here on name an exception */

/* Makes the two ends of a channel; the child inherits its own. Returns 0 or an errno. */
static int make_channel(struct channel *channel, int silence_s, HANDLE *end)
{
    SECURITY_ATTRIBUTES inherited = {sizeof inherited, NULL, TRUE};
    wchar_t name[96];
    swprintf(name, 96, L"\\\\.\\pipe\\sonject-%ld-%016" PRIx64, process_number(), unique_number());
    HANDLE own = CreateNamedPipeW(
        name, PIPE_ACCESS_DUPLEX | FILE_FLAG_OVERLAPPED | FILE_FLAG_FIRST_PIPE_INSTANCE,
        PIPE_TYPE_BYTE | PIPE_REJECT_REMOTE_CLIENTS, 1, PIPE_BYTES, PIPE_BYTES, 0, NULL);
    if (own == INVALID_HANDLE_VALUE)
        return last_errno();
    *end = CreateFileW(name, GENERIC_READ | GENERIC_WRITE, 0, &inherited, OPEN_EXISTING, 0, NULL);
    channel->pending = *end == INVALID_HANDLE_VALUE ? NULL : CreateEventW(NULL, TRUE, FALSE, NULL);
    if (!channel->pending) {
        const int error = last_errno();
        if (*end != INVALID_HANDLE_VALUE)
            CloseHandle(*end);
        CloseHandle(own);
        return error;
    }
    channel->end = (intptr_t)own;
    channel->silence_s = silence_s;
    return 0;
}

static void close_channel(struct channel *channel)
{
    CloseHandle((HANDLE)channel->end);
    CloseHandle(channel->pending);
    channel->end = 0;
    channel->pending = NULL;
}

/* Makes a job, which ends with its last handle and limits memory; NULL if the system refuses. */
static HANDLE make_job(uint64_t memory_bytes)
{
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits;
    HANDLE job = CreateJobObjectW(NULL, NULL);
    memset(&limits, 0, sizeof limits);
    limits.BasicLimitInformation.LimitFlags =
        JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE | JOB_OBJECT_LIMIT_PROCESS_MEMORY;
    limits.ProcessMemoryLimit = (SIZE_T)memory_bytes;
    if (job &&
        !SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits)) {
        CloseHandle(job);
        job = NULL;
    }
    return job;
}

/* Starts the process, suspended, with two handles and no others. Returns 0 or an errno. */
static int create_process(const wchar_t *program, wchar_t *line, HANDLE end, HANDLE nowhere,
                          PROCESS_INFORMATION *made)
{
    HANDLE handles[2] = {end, nowhere};
    STARTUPINFOEXW start;
    SIZE_T bytes = 0;
    memset(&start, 0, sizeof start);
    InitializeProcThreadAttributeList(NULL, 1, 0, &bytes);
    start.lpAttributeList = malloc(bytes);
    if (!start.lpAttributeList)
        return ENOMEM;
    start.StartupInfo.cb = sizeof start;
    start.StartupInfo.dwFlags = STARTF_USESTDHANDLES;
    start.StartupInfo.hStdInput = end;
    start.StartupInfo.hStdOutput = start.StartupInfo.hStdError = nowhere;
    bool is_made = InitializeProcThreadAttributeList(start.lpAttributeList, 1, 0, &bytes);
    if (is_made) {
        is_made =
            UpdateProcThreadAttribute(start.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST,
                                      handles, sizeof handles, NULL, NULL) &&
            CreateProcessW(program, line, NULL, NULL, TRUE,
                           EXTENDED_STARTUPINFO_PRESENT | CREATE_SUSPENDED | CREATE_NO_WINDOW |
                               CREATE_NEW_PROCESS_GROUP,
                           NULL, NULL, &start.StartupInfo, made);
        DeleteProcThreadAttributeList(start.lpAttributeList);
    }
    const int error = is_made ? 0 : last_errno();
    free(start.lpAttributeList);
    return error;
}

/* Starts the program in the job. Returns 0 or an errno. */
static int start_in_job(struct child *child, const char *program, const char *argument, HANDLE end,
                        HANDLE nowhere)
{
    PROCESS_INFORMATION made;
    const size_t bytes = strlen(program) + strlen(argument) + 8;
    char *line = malloc(bytes);
    if (!line)
        return ENOMEM;
    snprintf(line, bytes, "\"%s\" \"%s\"", program, argument);
    wchar_t *wide_line = wide_text(line), *wide_program = wide_text(program);
    int error = wide_line && wide_program
                    ? create_process(wide_program, wide_line, end, nowhere, &made)
                    : errno;
    free(line);
    free(wide_line);
    free(wide_program);
    if (error != 0)
        return error;
    if (!AssignProcessToJobObject(child->job, made.hProcess)) {
        error = last_errno();
        TerminateProcess(made.hProcess, 1);
        CloseHandle(made.hProcess);
    } else {
        ResumeThread(made.hThread);
        child->process = made.hProcess;
        child->number = (long)made.dwProcessId;
        child->owner = process_number();
    }
    CloseHandle(made.hThread);
    return error;
}

int child_start(struct child *child, const char *program, const char *argument,
                uint64_t memory_bytes, int silence_s)
{
    SECURITY_ATTRIBUTES inherited = {sizeof inherited, NULL, TRUE};
    HANDLE end;
    int error = make_channel(&child->channel, silence_s, &end);
    if (error != 0)
        return error;
    HANDLE nowhere =
        CreateFileW(L"NUL", GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE,
                    &inherited, OPEN_EXISTING, 0, NULL);
    child->job = make_job(memory_bytes);
    error = nowhere == INVALID_HANDLE_VALUE || !child->job
                ? last_errno()
                : start_in_job(child, program, argument, end, nowhere);
    CloseHandle(end);
    if (nowhere != INVALID_HANDLE_VALUE)
        CloseHandle(nowhere);
    if (error != 0) {
        close_channel(&child->channel);
        if (child->job)
            CloseHandle(child->job);
        child->job = NULL;
    }
    return error;
}

struct child_end child_stop(struct child *child)
{
    struct child_end end = {0};
    DWORD code = 0;
    if (child->number == 0)
        return end;
    close_channel(&child->channel); /* the child ends with the channel, if not before */
    end.is_known = WaitForSingleObject(child->process, STOP_WAIT_MS) == WAIT_OBJECT_0 &&
                   GetExitCodeProcess(child->process, &code);
    end.has_exited = end.is_known && code < CRASHES;
    end.status = end.has_exited ? (int)code : 0;
    if (end.is_known && !end.has_exited)
        snprintf(end.reason, sizeof end.reason, " (exception %08lX)", (unsigned long)code);
    CloseHandle(child->job);
    CloseHandle(child->process);
    child->number = 0;
    return end;
}

/* Waits wait_ms milliseconds for a pending operation. Returns the bytes moved, or -1 with errno. */
static long finish(const struct channel *channel, OVERLAPPED *begun, DWORD wait_ms)
{
    HANDLE end = (HANDLE)channel->end;
    DWORD moved = 0;
    if (GetLastError() == ERROR_IO_PENDING &&
        WaitForSingleObject(channel->pending, wait_ms) != WAIT_OBJECT_0)
        CancelIoEx(end, begun);
    if (GetOverlappedResult(end, begun, &moved, TRUE))
        return (long)moved;
    errno = GetLastError() == ERROR_OPERATION_ABORTED ? EAGAIN : last_errno();
    return -1;
}

bool channel_send(const struct channel *channel, const void *bytes, size_t count)
{
    const char *rest = bytes;
    while (count > 0) {
        const DWORD some = (DWORD)(count < MOVED_MAX ? count : MOVED_MAX);
        OVERLAPPED begun = {.hEvent = channel->pending};
        DWORD moved = 0;
        const bool is_moved =
            WriteFile((HANDLE)channel->end, rest, some, &moved, channel->pending ? &begun : NULL);
        if (!is_moved && channel->pending && GetLastError() == ERROR_IO_PENDING) {
            const long sent = finish(channel, &begun, 1000 * (DWORD)channel->silence_s);
            if (sent < 0)
                return false;
            moved = (DWORD)sent;
        } else if (!is_moved) {
            errno = last_errno();
            return false;
        }
        rest += moved;
        count -= moved;
    }
    return true;
}

long channel_receive(const struct channel *channel, void *bytes, size_t count)
{
    const DWORD some = (DWORD)(count < MOVED_MAX ? count : MOVED_MAX);
    OVERLAPPED begun = {.hEvent = channel->pending};
    DWORD moved = 0;
    if (ReadFile((HANDLE)channel->end, bytes, some, &moved, channel->pending ? &begun : NULL))
        return (long)moved;
    long got = -1;
    if (channel->pending && GetLastError() == ERROR_IO_PENDING)
        got = finish(channel, &begun, 1000 / CHILD_WAITS_PER_SECOND);
    else
        errno = last_errno();
    return got < 0 && errno == EPIPE ? 0 : got;
}

/* Keeps windows away. The job limits memory, and ends this process with its starter. */
bool child_begin(struct channel *channel, uint64_t memory_bytes)
{
    (void)memory_bytes;
    SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX); /* no window for errors */
    *channel = (struct channel){.end = (intptr_t)GetStdHandle(STD_INPUT_HANDLE)};
    return true;
}

/* Does nothing: Windows limits only the time of a whole process. The starter's wait is limited. */
void child_limit_time(int seconds)
{
    (void)seconds;
}

void child_exit(void)
{
    ExitProcess(0);
}
