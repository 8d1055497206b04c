#pragma once

#include <array>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/classify/classify.hpp"
#include "flies/concentrate/concentrate.hpp"
#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/evolve/evolve.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/propose/propose.hpp"
#include "flies/road/road.hpp"
#include "flies/scan/scan.hpp"

namespace flies {

/// All options of the method, nested like the calls. `DetectorOptions{}` is the preset `default`.
struct DetectorOptions {
  std::uint64_t seed = 1;
  int threads = 1;
  FieldOptions field;
  FitnessOptions fitness;
  RoadOptions road;
  EvolveOptions evolve;
  ScanOptions scan;
  ConcentrateOptions concentrate;
  ProposeOptions propose;
  ClassifyOptions classify;

  template <class Self, class Field>
  static void fields(Self& self, Field&& f) {
    f("seed", self.seed, "seed of all random numbers; same input, seed and options give the same result");
    f("threads", self.threads, Range{0, 256}, "worker threads, 0 for one per core; results do not depend on it");
    f("field", self.field);
    f("fitness", self.fitness);
    f("road", self.road);
    f("evolve", self.evolve);
    f("scan", self.scan);
    f("concentrate", self.concentrate);
    f("propose", self.propose);
    f("classify", self.classify);
  }
};

/// Named sets of options: values, not code paths.
enum class Preset {
  standard,  ///< "default": what works best on roads
  paper,     ///< Li, Toulminet, Nashashibi 2010 as closely as the text lets us
  robot,     ///< 0.2 to 1 m above a floor, 0.3 to 12 m ahead, things from 3 cm up
  handheld,  ///< carried, held or flown: any height and tilt, uneven ground, 0.3 to 20 m ahead
};
template <>
struct EnumNames<Preset> {
  static constexpr std::array<std::string_view, 4> names = {"default", "paper", "robot", "handheld"};
};
DetectorOptions preset_options(Preset preset);

/// The people model of a preset, a name that `people_classifier` knows: the shipped one; of `paper` its linear machine
/// alone.
std::string_view preset_people_model(Preset preset);

/// Its classifier.
std::shared_ptr<const PeopleClassifier> preset_classifier(Preset preset);

/// The options of a preset made for a camera. Presets have a car's camera in mind; of another one's field of detection,
/// scan and search for the road, the near ends follow from where it sees the road first and where both of its images
/// see the same, the far ends from where ranges get worse than 15 % and the road too flat. Nothing is looked for
/// farther away than the preset says, and nothing changes for a KITTI car. docs/cameras.md has the rules.
/// @param camera with its image size and its mount; what depends on a size that is not known stays
DetectorOptions fitted_options(const StereoCamera& camera, DetectorOptions options);

/// @throws InputError naming `source`, the option `preset` and the known names
Preset preset_named(std::string_view name, const std::string& source);

/// Checks every option against its range and those that depend on each other.
/// @throws InputError naming `source` and the option
void check_detector_options(const DetectorOptions& options, const std::string& source);

/// What was found in one pair.
struct DetectionSummary {
  std::vector<Obstacle> obstacles;      ///< nearest first
  std::vector<Pedestrian> pedestrians;  ///< nearest first
  Scan scan;                            ///< the nearest obstacle in every direction, and where the ground is free
  StageTimes_ms stage_ms{};             ///< how long each stage took
};

/// The same with every intermediate result on the way there: some 300 kB more with 3000 flies.
struct Detection : DetectionSummary {
  RoadResult road;
  EvolveResult evolved;  ///< flies after the last generation, scored
  ConcentrateResult
      concentrate;        ///< its `obstacles` are what the flies show of those above; people are looked for there
  std::vector<Roi> rois;  ///< `Roi::obstacle` counts `concentrate.obstacles`, people of the pair before, then the scan
  std::vector<double> roi_scores;  ///< the classifier's first look: one probability per ROI
};

namespace detail {

/// Tells a use from two threads at once from one after the other. A copy is its own.
class OneAtATime {
 public:
  OneAtATime() = default;
  OneAtATime(const OneAtATime&) {}
  OneAtATime& operator=(const OneAtATime&) { return *this; }

  class Use {
   public:
    explicit Use(OneAtATime& owner) : owner_(owner) {
      [[maybe_unused]] const bool was_in_use = owner_.is_in_use_.exchange(true);
      assert(!was_in_use && "one Detector must not be used from two threads at once");
    }
    ~Use() { owner_.is_in_use_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    OneAtATime& owner_;
  };

 private:
  std::atomic<bool> is_in_use_{false};
};

}  // namespace detail

/// Finds obstacles and pedestrians in rectified pairs of one camera. What it remembers from pair to pair: their count,
/// so that each gets random numbers of its own, the obstacles of the last one, which steer some flies of the next
/// (`evolve.steering_share`), and its people, who are looked for again where the camera's motion is known. Copies share
/// their worker threads. The n-th call is a function of the pairs so far, camera, options and classifier. Threads: one
/// detector serves one thread at a time; several detectors, copies too, may run side by side. One that was moved from
/// may be assigned to and destroyed; `process` and `find` throw std::logic_error.
class Detector {
 public:
  /// @param classifier of people; null: nobody is looked for, boxes score 0 and `pedestrians` stays empty
  /// @throws InputError when the camera or an option is out of range, or the unit of the baseline or focal length wrong
  explicit Detector(const StereoCamera& camera, const DetectorOptions& options = {},
                    std::shared_ptr<const PeopleClassifier> classifier = default_people_classifier());

  /// @param pair of the size the camera was calibrated for
  /// @throws InputError when images are empty, one twice, swapped (every 32nd pair is asked), or of the wrong size
  /// @param motion of the camera since the last pair that was not refused, where that is known: what was seen then
  ///               counts on
  Detection process(const RectifiedPair& pair, const std::optional<PlanarMotion>& motion = std::nullopt);

  /// The same where the motion has yet to be measured: `motion` runs beside the first stages when `threads` is not 1.
  Detection process(const RectifiedPair& pair, const MotionSource& motion);

  /// The same without the intermediate results, for who keeps what comes out.
  DetectionSummary find(const RectifiedPair& pair, const std::optional<PlanarMotion>& motion = std::nullopt);

  /// Forgets the pairs so far: the next one is treated as the first, as after a jump to another place.
  void reset();

  const StereoCamera& camera() const { return camera_; }
  const DetectorOptions& options() const { return options_; }

 private:
  struct Workers;

  Detection detect(const RectifiedPair& pair, const MotionSource& motion);
  /// @returns how the camera moved since the pair before, where that is known
  std::optional<PlanarMotion> find_obstacles(const RectifiedPair& pair, const MotionSource& motion, Detection& d);
  void find_pedestrians(const RectifiedPair& pair, const std::optional<PlanarMotion>& moved, Detection& d) const;

  StereoCamera camera_;
  Projection projection_;
  DetectorOptions options_;
  std::shared_ptr<const PeopleClassifier> classifier_;
  std::shared_ptr<Workers> workers_;
  Evolver evolver_;
  Scanner scanner_;
  Concentrator concentrator_;
  std::vector<Obstacle> last_obstacles_;
  std::vector<Pedestrian> last_pedestrians_;
  std::uint32_t frame_ = 0;
  detail::OneAtATime one_at_a_time_;
};

}  // namespace flies
