#include <algorithm>
#include <utility>
#include <vector>

#include "evaluate/evaluation_report.hpp"
#include "flies/draw/curves.hpp"

cv::Mat people_curves(const flies::Evaluation& evaluation) {
  std::vector<flies::ErrorCurve> curves;
  for (const auto& method : evaluation.methods)
    if (method.people) curves.push_back({method.name, method.people->curve, method.people->operating_point});
  return flies::draw_error_curves(curves, {.false_positives_label = "false alarms a pair",
                                           .min_false_positives = 1e-2,
                                           .max_false_positives = 10.0,
                                           .min_miss_rate = 0.02});
}

cv::Mat scan_curves(const flies::Evaluation& evaluation) {
  std::vector<flies::ErrorCurve> curves;
  for (const auto& method : evaluation.methods) {
    if (!method.scan) continue;
    const auto point_of = [](const auto& values, const auto& value_of) {
      const auto share = [&](const char* measure) {
        const auto found = values.find({flies::MeasureKey::Group::all, "", measure});
        return found == values.end() ? 0.0 : value_of(found->second);
      };
      return flies::ErrorPoint{share("ghost"), share("blind")};
    };
    flies::ErrorCurve curve{method.name, {}, {}};
    for (const auto& point : method.scan->curve)
      curve.points.push_back(point_of(point.values, [](double value) { return value; }));
    std::sort(curve.points.begin(), curve.points.end(),
              [](const auto& a, const auto& b) { return a.false_positives < b.false_positives; });
    curve.operating_point = point_of(method.scan->estimates, [](const flies::Estimate& e) { return e.median; });
    curves.push_back(std::move(curve));
  }
  return flies::draw_error_curves(curves, {.false_positives_label = "ghost sectors, share",
                                           .miss_rate_label = "blind sectors, share",
                                           .min_false_positives = 1e-2,
                                           .max_false_positives = 1.0,
                                           .min_miss_rate = 0.01});
}
