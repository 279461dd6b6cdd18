/* SPDX-License-Identifier: MIT */
/* What the tables of the models do not say: what directives do, and which words pbrt-v4 knows too. */
#ifndef SR_TOOLS_FORMATS_WORDS_H
#define SR_TOOLS_FORMATS_WORDS_H

struct format_word {
    const char *kind, *name, *text;
};
/* Kind "directive", "annotation", or of a plugin; ends with a NULL kind. */
extern const struct format_word format_texts[];
/* text: the parameters that pbrt-v4 reads, with blanks between them; name "": of all plugins of the kind. */
extern const struct format_word format_pbrt[];
/* What parameters mean where their table has choices or a default in place of a sentence; kind "": any. */
extern const struct format_word format_meanings[];

#endif
