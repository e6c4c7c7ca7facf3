#include "tools/thesis/chapter7_statements.h"

#include "tools/thesis/chapter7_parts.h"
#include "tools/thesis/control_text.h"

namespace flexarm {

std::vector<Statement> Chapter7Statements(const ControlStudy& study) {
  return Joined(Joined(LawStatements(study), SimulationStatements(study)),
                ExperimentStatements(study));
}

}  // namespace flexarm
