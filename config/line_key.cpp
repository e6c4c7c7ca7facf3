#include "config/line_key.h"

#include "hal/line_names.h"

namespace flexarm {

void ReadLine(TableReader row, Line* out) {
  using enum Line;
  row.Read("line", out,
           {{ToString(kLimit1Low), kLimit1Low},
            {ToString(kLimit1High), kLimit1High},
            {ToString(kLimit2Low), kLimit2Low},
            {ToString(kLimit2High), kLimit2High},
            {ToString(kEmergencyStop), kEmergencyStop},
            {ToString(kResetButton), kResetButton}},
           "name of a line of the safety chain");
}

}  // namespace flexarm
