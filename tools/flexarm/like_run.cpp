#include "tools/flexarm/like_run.h"

#include <cmath>

#include "controller/files/input_error.h"
#include "controller/types/rounded_text.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

std::string EstimateText(const StepOutput& last) {
  if (!std::isfinite(last.payload_kg) || !std::isfinite(last.payload_sigma_kg)) return {};
  return RoundedText(last.payload_kg, 2, true) + " +- " +
         RoundedText(last.payload_sigma_kg, 2, true) + " kg";
}

}  // namespace

LikeRun LoadLikeRun(const std::filesystem::path& file) {
  const LoadedRun run = LoadRun(file);
  if (!run.experiment || run.contents.tick.empty()) {
    throw InputError(file.string() + ": has no experiment with samples; expected the log of a run");
  }
  const TickRecord& first = run.contents.tick.front();
  LikeRun like{.config = run.config,
               .experiment = *run.experiment,
               .payload_kg = run.contents.info.payload_kg};
  if (run.contents.info.backend == "sim") {
    like.start_rad = first.truth.known
                         ? first.truth.hub_angle_rad
                         : std::array{first.output.angle_rad[0], first.output.angle_rad[1]};
    like.calibration = first.input.calibration;
  } else {
    like.payload_kg.reset();
    like.payload_estimate = EstimateText(run.contents.tick.back().output);
    like.start_rad = {first.output.angle_rad[0], first.output.angle_rad[1]};
  }
  return like;
}

}  // namespace flexarm
