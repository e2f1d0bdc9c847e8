/* The constants of the rounding bound. docs/theory/rounding.md derives them from counts of
 * operations; a test adds them up again and compares all with that page. In units of u, the
 * rounding to nearest. */
#ifndef MR_ROUNDING_H
#define MR_ROUNDING_H

#define MR_U 0x1p-53

#define MR_CONSTANT_ROTATION 2.0 /* entries of a constant rotation are its nearest doubles */
#define MR_CONSTANT_LEVER 1.0
#define MR_CONSTANT_AXIS 1.0
#define MR_ROTATION 19.0 /* of a link to its parent */
#define MR_LEVER 15.0    /* between joint and link frame */

/* |R' R - 1| of a rotation's nearest doubles; what exceeds it counts for each use of a rotation. */
#define MR_NO_DEFECT 4.0
#define MR_DEFECTS 8.0

/* Errors grow with the depth of the tree: per joint on the path, and once. */
#define MR_MOTION_JOINT 39.0 /* acceleration and moment of a body, before mass */
#define MR_MOTION_ONCE 50.0
#define MR_NOMINAL_JOINT 66.0 /* torque of NE*; each body and joint adds its summation */
#define MR_NOMINAL_ONCE 90.0
#define MR_CHANGE_JOINT 183.0 /* the hull's deviation from it */
#define MR_CHANGE_ONCE 500.0

/* Boxes of `ianea`, beside the errors of rotations, levers and the motion. */
#define MR_BOX_BODY 12.0
#define MR_BOX_ROTATION 8.0
#define MR_BOX_MOMENT 4.0
#define MR_BOX_AXIS 4.0
/* Radii, relative to themselves: per joint on the path, once, and per body and joint. */
#define MR_RADIUS_JOINT 16.0
#define MR_RADIUS_ONCE 96.0
#define MR_RADIUS_SUM 4.0

/* Second-order terms and the rounding of the sizes, for rates up to MR_RATE_MAX. */
#define MR_SECOND_ORDER (1.0 + 0x1p-19)
#define MR_RATE_MAX 0x1p-21

#define MR_DRIVE 32.0 /* torque of a drive, and its part in the sums but those over mimic joints */

/* What a mimic joint's angle can add to the whole: 3 turns to a rate of 156, or 7 to one of 683. */
#define MR_MIMIC_ANGLE 0x1p-4

/* More than all that underflow takes away, 2^-1075 at a time, before the factors that follow. */
#define MR_UNDERFLOW 0x1p-1000

/* Beyond this a product could overflow unseen. */
#define MR_HUGE 0x1p900

#endif
