/* SPDX-License-Identifier: MIT */
/* What a file holds besides its frames: the clips of a glTF, the objects of an Alembic archive. */
#ifndef CONTENTS_H
#define CONTENTS_H

#include "json.h"
#include "session.h"

/* The files and their format in one line, or as members of the open object where `j` is not NULL. */
void contents_print_format(session *s, const input_options *input, const arguments *paths, json *j);

/* To a table, or as members of the open object where `j` is not NULL. Other files add nothing to the table. */
void contents_print(session *s, const input_options *input, const arguments *paths, json *j);

#endif
