#include "host_sim/commands/simulate_gyro_command.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/sources/simulated_gyro.hpp"

namespace cairn::host {
namespace {

struct SimulateArguments {
  std::filesystem::path truth;
  std::filesystem::path out;
  std::vector<double> rotation = {1.0, 0.0, 0.0, 0.0};
  bool force = false;
  GyroSimulation settings;
};

void simulate(const SimulateArguments& arguments) {
  GyroSimulation settings = arguments.settings;
  const std::vector<double>& q = arguments.rotation;
  settings.R_camera_gyro = Quaternion<double>(q[0], q[1], q[2], q[3]);
  if (!(std::abs(settings.R_camera_gyro.norm() - 1.0) <= 0.01)) {
    throw UsageError("--rotation: expected a unit quaternion W,X,Y,Z");
  }
  settings.R_camera_gyro.normalize();
  std::error_code ignored;
  if (std::filesystem::equivalent(arguments.truth, arguments.out, ignored)) {
    throw UsageError("--out: expected another file than TRUTH");
  }
  if (!arguments.force && std::filesystem::is_regular_file(arguments.out)) {
    throw UsageError(
        fmt::format("--out {}: is there already; --force replaces it", arguments.out.string()));
  }
  const std::vector<TimedPose> truth = read_tum(arguments.truth);
  if (truth.size() < 2) throw InputError(arguments.truth, "expected two poses or more");
  const std::vector<AngularRateSample> samples = simulate_gyro(truth, settings);
  if (samples.empty()) {
    throw InputError(arguments.truth,
                     "expected poses that follow one another in at most 0.2 s, found none");
  }
  OutputFile out(arguments.out);
  out.print("t_us,wx_radps,wy_radps,wz_radps\n");
  for (const AngularRateSample& sample : samples) {
    out.print("{},{:.9g},{:.9g},{:.9g}\n", sample.t_us, sample.rate_radps.x(),
              sample.rate_radps.y(), sample.rate_radps.z());
  }
  out.finish();
  fmt::print("{} samples in {}\n", samples.size(), arguments.out.string());
}

void add_options(CLI::App& command, SimulateArguments& arguments) {
  GyroSimulation& settings = arguments.settings;
  command.add_option("TRUTH", arguments.truth, "True poses of the camera (TUM)")->required();
  command.add_option("--out", arguments.out, "File for the samples (CSV)")->required();
  command.add_flag("--force", arguments.force, "Replace a file that is there");
  command.add_option("--rate", settings.rate_hz, "Samples a second")
      ->check(between(10.0, 10000.0))
      ->capture_default_str();
  command.add_option("--noise", settings.noise_density, "Noise density, rad/s/sqrt(Hz)")
      ->check(between(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option("--bias", settings.bias_sigma_radps,
                  "Standard deviation of each axis' bias at the start, rad/s")
      ->check(between(0.0, 10.0))
      ->capture_default_str();
  command.add_option("--bias-walk", settings.bias_walk, "How the bias walks, rad/s/sqrt(s)")
      ->check(between(0.0, 10.0))
      ->capture_default_str();
  command.add_option("--delay", settings.delay_s, "Stamps are late by this, s")
      ->check(between(-1.0, 1.0))
      ->capture_default_str();
  command.add_option("--range", settings.range_radps, "Readings stop at this, rad/s")
      ->check(above_zero())
      ->capture_default_str();
  command
      .add_option("--rotation", arguments.rotation,
                  "W,X,Y,Z: turns the gyroscope's axes to those of the camera")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--seed", settings.seed, "Seed of noise and bias")
      ->check(seed_number())
      ->capture_default_str();
}

}  // namespace

void register_simulate_gyro_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "simulate-gyro", "A gyroscope's samples from a camera's true poses, for --gyro");
  const auto arguments = std::make_shared<SimulateArguments>();
  add_options(*command, *arguments);
  command->callback([arguments] { simulate(*arguments); });
}

}  // namespace cairn::host
