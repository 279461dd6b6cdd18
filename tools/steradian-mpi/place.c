/* SPDX-License-Identifier: MIT */
/* steradian-mpi: which ranks render, and with how many threads.
 *
 * Launchers bind a rank to some of its node's processors. Where one rank renders for its whole node, it may run on what
 * all ranks of the node were given; where each renders for itself, those who were given the same processors share them
 * evenly. */
#define _GNU_SOURCE
#include "ranks.h"

#include <mpi.h>
#include <sched.h>
#include <string.h>
#include <unistd.h>

static cpu_set_t own_processors(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        CPU_SET(0, &set);
    return set;
}

/* Threads for one of the ranks of a node that were given these sets. */
static int share_of(const cpu_set_t *sets, int ranks, int own)
{
    int sharers = 0;
    for (int i = 0; i < ranks; ++i)
        sharers += CPU_EQUAL(&sets[i], &sets[own]);
    int threads = CPU_COUNT(&sets[own]) / sharers;
    return threads > 0 ? threads : 1;
}

void place_find(struct place *p, bool each, int wanted_threads)
{
    MPI_Comm_rank(MPI_COMM_WORLD, &p->rank);
    MPI_Comm_size(MPI_COMM_WORLD, &p->ranks);
    MPI_Comm node;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, p->rank, MPI_INFO_NULL, &node);
    int node_rank, node_ranks, leader = p->rank;
    MPI_Comm_rank(node, &node_rank);
    MPI_Comm_size(node, &node_ranks);
    MPI_Bcast(&leader, 1, MPI_INT, 0, node);
    cpu_set_t own = own_processors(), *sets = sr_alloc((size_t)node_ranks * sizeof *sets), all = own;
    p->all = sr_alloc((size_t)p->ranks * sizeof *p->all);
    if (!sets || !p->all)
        MPI_Abort(MPI_COMM_WORLD, SR_ERROR_RESOURCE);
    MPI_Allgather(&own, sizeof own, MPI_BYTE, sets, sizeof own, MPI_BYTE, node);
    for (int i = 0; i < node_ranks; ++i)
        CPU_OR(&all, &all, &sets[i]);
    struct rank me = {.node_leader = leader};
    gethostname(me.host, sizeof me.host - 1);
    if (each)
        me.threads = wanted_threads ? wanted_threads : share_of(sets, node_ranks, node_rank);
    else if (node_rank == 0) {
        sched_setaffinity(0, sizeof all, &all); // where that is not allowed, it stays with its own
        me.threads = wanted_threads ? wanted_threads : sr_thread_count();
    }
    sr_free(sets);
    MPI_Allgather(&me, sizeof me, MPI_BYTE, p->all, sizeof me, MPI_BYTE, MPI_COMM_WORLD);
    MPI_Comm_free(&node);
    for (int i = 0; i < p->ranks; ++i) {
        p->renderers += p->all[i].threads > 0;
        p->hosts += p->all[i].node_leader == i;
    }
}
