/* SPDX-License-Identifier: MIT */
/* Proper rotations: 3x3 matrices by rows, and unit quaternions (x, y, z, w). */
#ifndef SPH_ROTATION_H
#define SPH_ROTATION_H

/*
 * The rotation (determinant +1) of largest trace(R' M): the nearest to M, and the Procrustes rotation where M = sum w q p'.
 * It is unique but where the two smaller singular values, the least taken with the sign of the determinant, sum to 0;
 * there it is one of the best. M = 0 gives the identity.
 */
void sph__nearest_rotation(const double m[9], double rotation[9]);

/*
 * The same, quickly where the rotation `near` is not far off; the result is then as much of a rotation as `near` is.
 * `rotation` may be `near`.
 */
void sph__nearest_rotation_from(const double m[9], const double near[9], double rotation[9]);

/* Eigenvalues, falling, and eigenvectors, one per row, of a symmetric 4x4 matrix (all 16 numbers). */
void sph__sym4_eigen(const double m[16], double values[4], double vectors[16]);

void sph__rotation_from_quaternion(const double q[4], double rotation[9]);
/* Of a rotation: from the largest of the four numbers, where nothing cancels (Shepperd 1978). */
void sph__quaternion_from_rotation(const double rotation[9], double q[4]);

#endif
