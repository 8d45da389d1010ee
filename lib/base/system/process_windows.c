#define _CRT_RAND_S /* for rand_s */
#include "base/system/process.h"

#include <fcntl.h>
#include <io.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <windows.h>

#include <psapi.h>
#include <shellapi.h>

#include "base/system/windows_text.h"

long process_number(void)
{
    return (long)GetCurrentProcessId();
}

uint32_t process_place(void)
{
    char name[MAX_COMPUTERNAME_LENGTH + 1] = "";
    DWORD length = sizeof name;
    uint32_t place = UINT32_C(2166136261); /* FNV-1a */
    if (!GetComputerNameA(name, &length))
        length = 0;
    for (DWORD i = 0; i < length; i++)
        place = (place ^ (unsigned char)name[i]) * UINT32_C(16777619);
    return place;
}

bool process_has_ended(long number)
{
    HANDLE process = OpenProcess(SYNCHRONIZE, FALSE, (DWORD)number);
    if (!process)
        return GetLastError() == ERROR_INVALID_PARAMETER; /* no process has this number */
    const bool has_ended = WaitForSingleObject(process, 0) == WAIT_OBJECT_0;
    CloseHandle(process);
    return has_ended;
}

uint64_t unique_number(void)
{
    unsigned low = 0, high = 0;
    LARGE_INTEGER now;
    if (rand_s(&low) != 0 || rand_s(&high) != 0)
        low = high = 0;
    QueryPerformanceCounter(&now);
    const uint64_t number = ((uint64_t)high << 32) | low;
    return number ^ ((uint64_t)now.QuadPart * UINT64_C(0x9E3779B97F4A7C15)) ^
           (uint64_t)(uintptr_t)&now;
}

double clock_seconds(void)
{
    LARGE_INTEGER now, per_second;
    QueryPerformanceCounter(&now);
    QueryPerformanceFrequency(&per_second);
    return (double)now.QuadPart / (double)per_second.QuadPart;
}

uint64_t peak_memory_bytes(void)
{
    PROCESS_MEMORY_COUNTERS used;
    return K32GetProcessMemoryInfo(GetCurrentProcess(), &used, sizeof used)
               ? used.PeakWorkingSetSize
               : 0;
}

/* Does nothing: Windows forks no process. */
void forks_watch(void (*begin_child)(void))
{
    (void)begin_child;
}

uint32_t processor_count(void)
{
    DWORD_PTR own = 0, all = 0;
    uint32_t count = 0;
    if (!GetProcessAffinityMask(GetCurrentProcess(), &own, &all))
        own = 1;
    for (; own != 0; own &= own - 1)
        count++;
    return count > 0 ? count : 1; /* 0: several groups of 64 processors */
}

bool thread_start(pthread_t *thread, void *(*run)(void *user), void *user)
{
    return pthread_create(thread, NULL, run, user) == 0;
}

void *library_load(const char *name, int number)
{
    char file[256];
    (void)number; /* not in Windows' names */
    snprintf(file, sizeof file, "%s.dll", name);
    return (void *)LoadLibraryA(file);
}

void *library_function(void *library, const char *name)
{
    const FARPROC function = GetProcAddress((HMODULE)library, name);
    void *address = NULL;
    memcpy(&address, &function, sizeof address);
    return address;
}

char *folder_of_code(const void *address)
{
    static const DWORD by_address =
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    wchar_t path[4096] = L"";
    HMODULE module = NULL;
    if (!GetModuleHandleExW(by_address, (const wchar_t *)address, &module) ||
        GetModuleFileNameW(module, path, 4095) == 0)
        path[0] = L'\0';
    wchar_t *last = wcsrchr(path, L'\\');
    if (last)
        *last = L'\0';
    return narrow_text(path);
}

void program_begin(int *count, char ***arguments)
{
    int given = 0;
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &given);
    char **narrow = wide ? calloc((size_t)given + 1, sizeof *narrow) : NULL;
    SetConsoleOutputCP(CP_UTF8);
    _setmode(1, _O_BINARY); /* '\n' alone ends lines */
    if (!narrow)
        return;
    for (int i = 0; i < given; i++)
        if (!(narrow[i] = narrow_text(wide[i])))
            return;
    *count = given;
    *arguments = narrow;
}

void signals_watch(void (*note)(int number))
{
    signal(SIGTERM, note);
    signal(SIGBREAK, note);
    signal(SIGINT, note); /* the system forgets note once it was called */
}

bool errors_are_shown(void)
{
    return _isatty(2) != 0;
}
