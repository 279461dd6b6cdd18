/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "run.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
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
    close(file);
}

static pid_t start_with(const char *arguments, const char *input)
{
    if (access(SR_TEST_COMMAND, X_OK) != 0)
        test_fail(__FILE__, __LINE__, "%s is not there: build it first", SR_TEST_COMMAND);
    char words[4096], out[512], err[512], *argv[128] = {(char[]){"steradian"}};
    int count = 1;
    snprintf(words, sizeof words, "%s", arguments);
    snprintf(out, sizeof out, "%s", in_folder("said.out"));
    snprintf(err, sizeof err, "%s", in_folder("said.err"));
    char *state;
    for (char *word = strtok_r(words, " ", &state); word && count < 127; word = strtok_r(NULL, " ", &state))
        argv[count++] = word;
    argv[count] = NULL;
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

const struct said *finish(pid_t pid)
{
    static struct said said;
    int status;
    EXPECT(waitpid(pid, &status, 0) == pid);
    said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
    slurp("said.out", said.out);
    slurp("said.err", said.err);
    if (said.code >= 126 && said.code != 130 && said.code != 143)
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
