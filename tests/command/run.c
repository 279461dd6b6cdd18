/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "run.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *in_folder(const char *name)
{
    static char paths[4][512];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", test_folder(), name);
    return path;
}

static void redirect(int fd, const char *path, int flags)
{
    int file = open(path, flags, 0666);
    if (file < 0 || dup2(file, fd) < 0)
        _exit(126);
    if (file != fd) // it is where that was closed
        close(file);
}

/* Words end at blanks, but for those of folders that stand in them. */
static int split(char *text, char **words, int most)
{
    const char *const folders[] = {SR_TEST_SOURCE_DIR, SR_TEST_REFERENCE_DIR, test_folder()};
    int count = 0;
    for (char *p = text; *p && count < most;) {
        p += strspn(p, " ");
        if (*p)
            words[count++] = p;
        while (*p && *p != ' ') {
            size_t step = 1;
            for (size_t i = 0; i < sizeof folders / sizeof *folders; ++i)
                if (strncmp(p, folders[i], strlen(folders[i])) == 0)
                    step = strlen(folders[i]);
            p += step;
        }
        if (*p)
            *p++ = 0;
    }
    return count;
}

static pid_t start_with(const char *arguments, const char *input)
{
    if (access(SR_TEST_COMMAND, X_OK) != 0)
        test_fail(__FILE__, __LINE__, "%s is not there: build it first", SR_TEST_COMMAND);
    char words[4096], out[512], err[512], *argv[128] = {(char[]){"steradian"}};
    snprintf(words, sizeof words, "%s", arguments);
    snprintf(out, sizeof out, "%s", in_folder("said.out"));
    snprintf(err, sizeof err, "%s", in_folder("said.err"));
    argv[1 + split(words, argv + 1, 126)] = NULL;
    const char *folder = test_folder();
    pid_t pid = fork();
    if (pid == 0) {
        if (chdir(folder) != 0)
            _exit(126);
        redirect(STDIN_FILENO, input ? input : "/dev/null", O_RDONLY);
        redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT | O_TRUNC);
        redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT | O_TRUNC);
        execv(SR_TEST_COMMAND, argv);
        _exit(127);
    }
    EXPECT(pid > 0);
    return pid;
}

static void slurp(const char *name, char text[MAX_SAID])
{
    FILE *file = fopen(in_folder(name), "rb");
    size_t n = file ? fread(text, 1, MAX_SAID - 1, file) : 0;
    text[n] = 0;
    if (file)
        fclose(file);
}

/* From the mask of /proc/PID/status; where there is none, time must do. What has ended catches nothing any more. */
static bool is_caught(pid_t pid, int number)
{
    char path[64], line[256];
    unsigned long long mask = 0;
    snprintf(path, sizeof path, "/proc/%ld/status", (long)pid);
    FILE *file = fopen(path, "r");
    if (!file) {
        sleep(2);
        return true;
    }
    bool has_ended = false;
    while (fgets(line, sizeof line, file)) {
        has_ended |= strncmp(line, "State:\tZ", 8) == 0;
        if (sscanf(line, "SigCgt: %llx", &mask) == 1)
            break;
    }
    fclose(file);
    return has_ended || (mask >> (number - 1) & 1);
}

void wait_until_caught(pid_t pid, int number)
{
    double start_s = sr_clock_s();
    while (!is_caught(pid, number) && sr_clock_s() - start_s < TEST_FOREVER_S)
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

const struct said *finish(pid_t pid)
{
    static struct said said;
    int status;
    EXPECT(waitpid(pid, &status, 0) == pid);
    said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
    slurp("said.out", said.out);
    slurp("said.err", said.err);
    if (said.code >= 126 && said.code != 129 && said.code != 130 && said.code != 143)
        test_fail(__FILE__, __LINE__, "crashed with %d: %s", said.code, said.err);
    if (strstr(said.err, "Sanitizer") || strstr(said.err, "runtime error"))
        test_fail(__FILE__, __LINE__, "%s", said.err);
    return &said;
}

pid_t start(const char *arguments)
{
    return start_with(arguments, NULL);
}

const struct said *run(const char *arguments, const char *input)
{
    return finish(start_with(arguments, input));
}

const struct said *run_expecting(int code, const char *arguments)
{
    const struct said *s = run(arguments, NULL);
    if (s->code != code)
        test_fail(__FILE__, __LINE__, "exit code %d, expected %d, of: steradian %s\n%s", s->code, code, arguments,
                  s->err);
    return s;
}

void put_file(const char *name, const char *text)
{
    FILE *file = fopen(in_folder(name), "wb");
    EXPECT(file != NULL);
    EXPECT(fputs(text, file) >= 0 && fclose(file) == 0);
}

struct sr_image *get_image(const char *name)
{
    struct sr_image *image;
    struct sr_error error = {0};
    if (sr_image_read(in_folder(name), &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return image;
}

int count_files(const char *part)
{
    DIR *folder = opendir(test_folder());
    int count = 0;
    EXPECT(folder != NULL);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
        count += strstr(entry->d_name, part) != NULL;
    closedir(folder);
    return count;
}

void remove_file(const char *name)
{
    unlink(in_folder(name));
}

json_t *json_of(const struct said *s)
{
    json_error_t error;
    json_t *j = json_loads(s->out, JSON_REJECT_DUPLICATES, &error);
    if (!j)
        test_fail(__FILE__, __LINE__, "%s (line %d) in: %s", error.text, error.line, s->out);
    return j;
}
