// Which of Bullet's two builds this is compiled against.
#pragma once

#include <LinearMath/btScalar.h>

/// Everything of this room stands in an inline namespace named after btScalar: headers set to one precision and a
/// library built for the other do not link. Elsewhere they would, and corrupt memory.
#ifdef BT_USE_DOUBLE_PRECISION
#define GRAPESHOT_PRECISION f64
#else
#define GRAPESHOT_PRECISION f32
#endif
