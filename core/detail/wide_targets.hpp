// For which instruction sets the wide kernels are compiled: AVX-512, AVX2 and a scalar twin, always all three on x86-64
// (whatever -march says), so that the choice at run time is a real one. Include before any header of Highway.
#pragma once

#ifdef HIGHWAY_HWY_DETECT_TARGETS_H_
#error "include <grapeshot/core/detail/wide_targets.hpp> before hwy/*.h"
#endif

// The twin is plain C++, not Highway's emulation (EMU128).
#define HWY_BROKEN_EMU128 1
#define HWY_BASELINE_TARGETS HWY_SCALAR
#ifdef GRAPESHOT_SCALAR
#define HWY_COMPILE_ONLY_SCALAR
#else
#define HWY_DISABLED_TARGETS (~(HWY_AVX3 | HWY_AVX2 | HWY_SCALAR))
#endif
