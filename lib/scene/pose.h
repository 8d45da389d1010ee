/* Directions of an object's own axes. */
#ifndef SONJECT_SCENE_POSE_H
#define SONJECT_SCENE_POSE_H

/* Rows: nose, own y, own z, in the axes that the angles (rad) are counted in: heading turns x
 * towards y, pitch raises the nose, roll turns about it. */
void turn_axes(double axes[3][3], double heading, double pitch, double roll);

/* Rows of `inner`, given in the axes that the rows of `outer` are, in those that outer's are given
 * in. product may not be one of both. */
void compose_axes(double product[3][3], double inner[3][3], double outer[3][3]);

#endif
