#include "config/line_key.h"

#include "hal/line_names.h"

namespace flexarm {

void ReadLine(TableReader row, Line* out) {
  using enum Line;
  row.Read("line", out,
           {{Name(kLimit1Low), kLimit1Low},
            {Name(kLimit1High), kLimit1High},
            {Name(kLimit2Low), kLimit2Low},
            {Name(kLimit2High), kLimit2High},
            {Name(kEmergencyStop), kEmergencyStop},
            {Name(kResetButton), kResetButton}});
}

}  // namespace flexarm
