/* SPDX-License-Identifier: MIT */
/* Files of named sections that are whole or are found out: checkpoints, and parts of a picture.
 *
 * A header of 64 bytes, then each section: 64 bytes about it, its bytes, and a checksum (CRC-32) for each 64 KiB of
 * them; all of it starts at multiples of 64 bytes, and gaps are zero. Every bit is under a checksum or must have one
 * value, so that a flipped bit, a missing end, a block in another's place is an error that says where. Numbers are
 * little-endian.
 *
 * A file is written beside its name, and bears it only once it is on the disk: see sr_store_finish. */
#ifndef SR_STORE_STORE_H
#define SR_STORE_STORE_H

#include "base/base.h"

enum {
    SR_STORE_KIND = 16,       // [B] with the NUL
    SR_STORE_NAME = 40,       // [B] with the NUL
    SR_STORE_BLOCK = 1 << 16, // [B] that share a checksum
    SR_STORE_SECTIONS = 4096, // at most
};

/* ---- writing ---- */

struct sr_store_out;
/* Opens FILE.new. Two writers of one file: the second fails. */
sr_status sr_store_create(const char *path, const char *kind, struct sr_store_out **out, struct sr_error *error);
sr_status sr_store_put(struct sr_store_out *out, const char *name, const void *data, size_t size,
                       struct sr_error *error);
/* FILE.new is brought to the disk and becomes FILE; what was FILE becomes FILE~ if it is to be kept. At each instant
 * FILE or FILE~ is whole if one of them was, also where this fails. out is gone in any case. */
sr_status sr_store_finish(struct sr_store_out *out, bool keeps_previous, struct sr_error *error);
/* Not wanted after all: FILE stays as it was. NULL is allowed. */
void sr_store_abandon(struct sr_store_out *out);

/* ---- reading ---- */

struct sr_store_in;
/* Reads the whole file and checks every bit of it. kind NULL: any. */
sr_status sr_store_open(const char *path, const char *kind, struct sr_store_in **in, struct sr_error *error);
/* The bytes of a section, aligned to 64; NULL: there is none of this name. They are there until the file is closed. */
const void *sr_store_get(const struct sr_store_in *in, const char *name, size_t *size);
const char *sr_store_kind(const struct sr_store_in *in);
/* The sections by number; false where they end. */
bool sr_store_section(const struct sr_store_in *in, uint32_t number, const char **name, size_t *size);
void sr_store_close(struct sr_store_in *in); // NULL is allowed

/* Whether the file begins as these files do, whatever follows. */
bool sr_store_is_store(const char *path);
/* What the file's folder says of its files, on the disk: a rename lasts only then. */
bool sr_store_sync_folder(const char *path);
/* Where the previous generation of a file is: FILE~. */
char *sr_store_previous(struct sr_arena *arena, const char *path);

#endif
