/* SPDX-License-Identifier: MIT */
/* What reading a hierarchy from bytes is made of. */
#ifndef SPH_HIERARCHY_FILE_H
#define SPH_HIERARCHY_FILE_H

#include "base/container.h"
#include "hierarchy/hierarchy.h"

/* The chunks of a hierarchy; docs/formats.md says what they hold. */
#define SPH__CHUNK_META SPH__TAG('M', 'E', 'T', 'A')
#define SPH__CHUNK_CENTERS SPH__TAG('C', 'E', 'N', 'T')
#define SPH__CHUNK_RADII SPH__TAG('R', 'A', 'D', 'I')
#define SPH__CHUNK_CHILDREN SPH__TAG('C', 'H', 'I', 'L')
#define SPH__CHUNK_COSTS SPH__TAG('C', 'O', 'S', 'T')
#define SPH__CHUNK_ERRORS SPH__TAG('E', 'R', 'R', 'O')
#define SPH__CHUNK_FORCED SPH__TAG('F', 'O', 'R', 'C')
#define SPH__CHUNK_EDGE_COUNTS SPH__TAG('E', 'D', 'G', 'N')
#define SPH__CHUNK_EDGES SPH__TAG('E', 'D', 'G', 'E')
#define SPH__CHUNK_TRIANGLE_COUNTS SPH__TAG('T', 'R', 'I', 'N')
#define SPH__CHUNK_TRIANGLES SPH__TAG('T', 'R', 'I', 'A')

/*
 * Checks the arrays of a hierarchy that was read, so that no later call can go out of range whatever they hold, and
 * fills in the parents and the first forced collapse. Lengths were checked before. SPH_E_FORMAT names the byte.
 */
sph_status sph__hierarchy_check(const sph__container *container, sph_hierarchy *hierarchy);

#endif
