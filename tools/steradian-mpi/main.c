/* SPDX-License-Identifier: MIT */
/* steradian-mpi: `steradian render` by many processes under mpirun or srun, to the same bytes.
 *
 * This thread talks MPI (pump.c), a second one runs the command itself. Rank 0 is a user's steradian render, with
 * helpers. */
#define _GNU_SOURCE
#include "ranks.h"

#include "render_command.h"

#include <mpi.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "Usage: mpirun -n N [...] steradian-mpi render SCENE [OPTIONS of steradian render] [OPTIONS]\n"
    "\n"
    "Renders one picture by N ranks, to the same bytes as steradian render. Rank 0 keeps the picture, writes the files and tells\n"
    "the progress. All ranks must see the scene's files under the same names, and run the same program on processors of one kind.\n"
    "\n"
    "      --threads N      of each rank that renders (default: all processors that its node's ranks were given)\n"
    "      --each-rank      every rank loads the scene and renders by itself, also several of one node: for NUMA domains, where\n"
    "                       memory allows. Default: the first rank of each node loads the scene and renders with the\n"
    "                       processors of all ranks of its node; the others wait and use none\n"
    "      --unit-log FILE  what each unit of work has cost, as a table (rank 0 writes it; see bench/simulate-ranks)\n"
    "\n"
    "Ctrl-C or SIGTERM to mpirun: rank 0 writes what there is. A rank that dies ends the job.\n"
    "\n"
    "Examples:\n"
    "  mpirun -n 4 --hostfile hosts --map-by node steradian-mpi render scene.pbrt -o out.exr\n"
    "  srun --nodes 8 --ntasks-per-node 1 --cpus-per-task 64 steradian-mpi render scene.pbrt -o out.exr --quiet\n"
    "  mpirun -n 2 steradian-mpi render scene.pbrt -o out.exr --each-rank --threads 1     (one machine, two processes)\n";

struct options {
    bool each, quiet, is_helpful;
    int threads;
    const char *unit_log;
};

/* Takes this program's own options out of the arguments. false: a value is missing. */
static bool take_options(int *argc, char **argv, struct options *o)
{
    int kept = 0;
    for (int i = 0; i < *argc; ++i) {
        const char *a = argv[i];
        const char *value = strchr(a, '=');
        size_t n = value ? (size_t)(value++ - a) : strlen(a);
#define IS(name) (n == sizeof name - 1 && memcmp(a, name, n) == 0)
        o->quiet |= IS("-q") || IS("--quiet");
        o->is_helpful |= IS("--help") || IS("-h");
        if (IS("--threads") || IS("--nthreads"))
            o->threads = atoi(value ? value : i + 1 < *argc ? argv[i + 1] : "0");
        if (IS("--each-rank")) {
            o->each = true;
        } else if (IS("--unit-log")) {
            o->unit_log = value ? value : i + 1 < *argc ? argv[++i] : NULL;
            if (!o->unit_log)
                return false;
        } else {
            argv[kept++] = argv[i];
        }
#undef IS
    }
    *argc = kept;
    argv[kept] = NULL;
    return true;
}

/* ---- a helper says nothing until all have met: rank 0 says the same ---- */

static int own_stdout = -1, own_stderr = -1;
static FILE *said;

void hush_begin(void)
{
    said = tmpfile();
    if (!said)
        return;
    own_stderr = dup(STDERR_FILENO);
    own_stdout = dup(STDOUT_FILENO);
    dup2(fileno(said), STDERR_FILENO);
    dup2(fileno(said), STDOUT_FILENO);
}

void hush_end(void)
{
    fflush(stdout);
    fflush(stderr);
    if (own_stderr >= 0)
        dup2(own_stderr, STDERR_FILENO);
    if (own_stdout >= 0)
        dup2(own_stdout, STDOUT_FILENO);
}

/* The last line that speaks of an error, or the last one. */
void hush_text(char text[RANKS_TEXT])
{
    text[0] = 0;
    fflush(stdout);
    fflush(stderr);
    char line[RANKS_TEXT];
    if (!said)
        return;
    rewind(said);
    for (bool is_error = false; fgets(line, sizeof line, said);)
        if (!is_error || strstr(line, "error: ")) {
            is_error |= strstr(line, "error: ") != NULL;
            memcpy(text, line, sizeof line);
        }
    text[strcspn(text, "\n")] = 0;
}

/* ---- the render, in a thread of its own ---- */

struct task {
    int argc;
    char **argv;
    struct crew *crew;
    struct ending ending;
};

static void *render(void *p)
{
    struct task *t = p;
    int code = command_render.run(t->argc, t->argv);
    fflush(stdout);
    pthread_mutex_lock(&t->crew->lock);
    t->ending.code = code;
    if (t->crew->hooks.is_helper && code)
        hush_text(t->ending.text);
    t->ending.is_ended = true;
    pthread_mutex_unlock(&t->crew->lock);
    return NULL;
}

static void introduce(const struct place *p, bool is_quiet)
{
    int waiting = p->ranks - p->renderers, most = 0;
    for (int i = 0; i < p->ranks; ++i)
        most = p->all[i].threads > most ? p->all[i].threads : most;
    if (is_quiet || p->ranks == 1)
        return;
    fprintf(stderr, "%d rank%s on %d host%s: %d render%s with %s%d thread%s", p->ranks, p->ranks == 1 ? "" : "s",
            p->hosts, p->hosts == 1 ? "" : "s", p->renderers, p->renderers == 1 ? "s" : "",
            p->renderers == 1 ? "" : "up to ", most, most == 1 ? "" : "s");
    if (waiting)
        fprintf(stderr, "; %d wait%s, as one scene serves all of a node (--each-rank: each loads it)", waiting,
                waiting == 1 ? "s" : "");
    fputc('\n', stderr);
}

static int render_with_others(int argc, char **argv, const struct options *o)
{
    static struct crew crew; // the render's thread may outlive this function
    static struct task task;
    place_find(&crew.place, o->each, o->threads);
    const struct rank *own = &crew.place.all[crew.place.rank];
    if (crew.place.rank > 0) { // rank 0 is asked, and says when all is over
        signal(SIGINT, SIG_IGN);
        signal(SIGTERM, SIG_IGN);
        signal(SIGHUP, SIG_IGN);
        signal(SIGUSR1, SIG_IGN);
    }
    if (!own->threads)
        return pump_wait();
    crew_begin(&crew);
    if (crew.hooks.is_helper)
        hush_begin();
    else
        introduce(&crew.place, o->quiet);
    render_crew =
        (struct render_crew){.hooks = &crew.hooks, .threads = own->threads, .processes = crew.place.renderers};
    task = (struct task){.argc = argc, .argv = argv, .crew = &crew};
    if (!unit_log_open(&crew, o->unit_log)) {
        task.ending.code = SR_ERROR_RESOURCE;
        task.ending.is_ended = true;
    } else {
        pthread_t thread;
        if (pthread_create(&thread, NULL, render, &task) != 0)
            MPI_Abort(MPI_COMM_WORLD, SR_ERROR_RESOURCE);
        pthread_detach(thread);
    }
    int code = pump(&crew, &task.ending);
    return unit_log_close(&crew) || code ? code : SR_ERROR_RESOURCE;
}

int main(int argc, char **argv)
{
    struct options o = {0};
    int provided, rank;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    bool is_whole = take_options(&argc, argv, &o);
    const char *name = argc > 1 ? argv[1] : "--help";
    int code = 0;
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        if (rank == 0)
            printf("steradian-mpi %s (%s), %d wavelengths a path\n", SR_VERSION, sr_isa(), SR_LAMBDA_COUNT);
    } else if (o.is_helpful || argc < 2) {
        if (rank == 0)
            fputs(help, argc > 1 ? stdout : stderr);
        code = argc > 1 ? 0 : SR_ERROR_USAGE;
    } else if (strcmp(name, "render") != 0 || !is_whole) {
        if (rank == 0)
            fprintf(stderr,
                    is_whole ? "steradian-mpi: the only subcommand is render; \"%s\" goes with steradian\n"
                             : "steradian-mpi: --unit-log: a file was expected%.0s\n",
                    name);
        code = SR_ERROR_USAGE;
    } else if (provided < MPI_THREAD_FUNNELED) {
        fprintf(stderr, "steradian-mpi: this MPI knows no threads\n");
        code = SR_ERROR_RESOURCE;
    } else {
        code = render_with_others(argc - 1, argv + 1, &o);
    }
    fflush(NULL);
    MPI_Finalize();
    _exit(rank == 0 ? code : 0); // a scene that is still being loaded need not be waited for
}
