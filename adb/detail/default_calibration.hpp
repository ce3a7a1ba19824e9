// The default calibration as text. What defines it is written at configure time from adb/default_calibration.txt.
#pragma once

#include <string_view>

namespace grapeshot::detail {

extern const std::string_view defaultCalibrationText;

}  // namespace grapeshot::detail
