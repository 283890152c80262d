#include "render/lod/blend_curve.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>

#include "core/base/error.h"

namespace lodestone {
namespace {

struct Form {
  BlendCurve::Kind kind;
  std::string_view prefix;
  std::size_t least, most;  // values
};
constexpr std::array forms{Form{BlendCurve::Kind::table, "table:", 2, 65},
                           Form{BlendCurve::Kind::polynomial, "polynomial:", 2, 8}};

const Form* form_of(std::string_view text) {
  const auto found = std::ranges::find_if(forms, [&](const Form& form) { return text.starts_with(form.prefix); });
  return found == forms.end() ? nullptr : &*found;
}

const Form& form_of(const BlendCurve& curve) { return forms[static_cast<std::size_t>(curve.kind)]; }

std::string number_text(float value) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

[[noreturn]] void refuse(const BlendCurve& curve, const std::string& what) {
  throw InputError("blending function '" + text_of(curve) + "' " + what);
}

// Control points of the derivative's Bernstein form on [0, 1], which its values lie between (farin2002).
std::vector<double> slopes(const std::vector<float>& coefficients) {
  const std::size_t degree = coefficients.size() - 2;  // of the derivative
  std::vector<double> points(degree + 1);
  for (std::size_t i = 0; i <= degree; ++i) {
    double share = 1;  // binomial(i, k) / binomial(degree, k)
    for (std::size_t k = 0; k <= i; ++k) {
      points[i] += share * static_cast<double>(k + 1) * static_cast<double>(coefficients[k + 1]);
      share *= static_cast<double>(i - k) / static_cast<double>(std::max<std::size_t>(degree - k, 1));
    }
  }
  return points;
}

// Bounds of the values that control points stand for: halved (de Casteljau) until the points are nearly the values.
struct Range {
  double least, most;
};
Range range_of(const std::vector<double>& points, int halvings = 8) {
  if (halvings == 0) {
    const auto [least, most] = std::ranges::minmax(points);
    return {least, most};
  }
  std::vector<double> lower{points.front()}, upper{points.back()}, left = points;
  while (left.size() > 1) {
    for (std::size_t i = 0; i + 1 < left.size(); ++i) left[i] = std::midpoint(left[i], left[i + 1]);
    left.pop_back();
    lower.push_back(left.front()), upper.push_back(left.back());
  }
  std::ranges::reverse(upper);
  const Range a = range_of(lower, halvings - 1), b = range_of(upper, halvings - 1);
  return {std::min(a.least, b.least), std::max(a.most, b.most)};
}

double steepest_line(const std::vector<float>& values) {
  double steepest = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    steepest = std::max(steepest, static_cast<double>(values[i]) - static_cast<double>(values[i - 1]));
  return steepest * static_cast<double>(values.size() - 1);
}

}  // namespace

std::string text_of(const BlendCurve& curve) {
  std::string text(form_of(curve).prefix);
  for (const float value : curve.values) text += number_text(value) + ",";
  if (!curve.values.empty()) text.pop_back();
  return text;
}

bool is_curve_text(std::string_view text) { return form_of(text) != nullptr; }

BlendCurve blend_curve(std::string_view text) {
  const Form* const form = form_of(text);
  if (!form)
    throw InputError("'" + std::string(text) + "' is not a blending function; write table:0,0.1,0.9,1 or the like");
  BlendCurve curve{form->kind, {}};
  const char* at = text.data() + form->prefix.size();
  const char* const end = text.data() + text.size();
  while (true) {
    float value = 0;
    const auto [after, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (after != end && *after != ','))
      throw InputError("blending function '" + std::string(text) + "': '" + std::string(at, end) +
                       "' does not begin with a number; separate numbers by commas");
    curve.values.push_back(value);
    if (after == end) break;
    at = after + 1;
  }
  check_curve(curve);
  return curve;
}

void check_curve(const BlendCurve& curve) {
  const std::vector<float>& values = curve.values;
  const Form& form = form_of(curve);
  if (values.size() < form.least || values.size() > form.most)
    refuse(curve, "has " + std::to_string(values.size()) + " values; give " + std::to_string(form.least) + " to " +
                      std::to_string(form.most));
  if (!std::ranges::all_of(values, [](float v) { return std::abs(v) <= 1e6f; }))
    refuse(curve, "has a value beyond a million, or none");
  const bool table = curve.kind == BlendCurve::Kind::table;
  const double end = table ? static_cast<double>(values.back()) : std::accumulate(values.begin(), values.end(), 0.0);
  if (values.front() != 0 || !(std::abs(end - 1) <= 1e-6)) refuse(curve, "must be 0 at 0 and 1 at 1");
  // Half an ulp of a coefficient may tip a slope of 0.
  const double slack = 1e-6 * std::accumulate(values.begin(), values.end(), 0.0, [](double sum, float v) {
                         return sum + std::abs(static_cast<double>(v));
                       });
  if (table ? !std::ranges::is_sorted(values) : range_of(slopes(values)).least < -slack)
    refuse(curve, "decreases somewhere, so that vertices would turn back");
}

double curve_lipschitz(const BlendCurve& curve) {
  if (curve.kind == BlendCurve::Kind::table) return steepest_line(curve.values);
  return range_of(slopes(curve.values)).most * (1 + 1e-6);
}

CurveShare::CurveShare(const BlendCurve& curve) : curve_(curve) {
  if (curve.kind == BlendCurve::Kind::table) return;
  const std::vector<float>& c = curve.values;
  for (std::size_t k = 0; k < c.size(); ++k) {  // of u^k, by the binomial theorem
    double sum = k == 0 ? 1 : 0, binomial = 1;
    for (std::size_t n = k; n < c.size(); ++n) {
      sum -= (k % 2 == 0 ? 1 : -1) * binomial * static_cast<double>(c[n]);
      binomial *= static_cast<double>(n + 1) / static_cast<double>(n + 1 - k);
    }
    from_end_.push_back(k == 0 ? 0 : static_cast<float>(sum));
  }
}

float CurveShare::operator()(float t) const {
  if (!(t > 0)) return 0;
  if (t >= 1) return 1;
  const std::vector<float>& values = curve_.values;
  float s = 0;
  if (curve_.kind == BlendCurve::Kind::table) {
    const float along = t * static_cast<float>(values.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(along), values.size() - 2);
    const float rise = (values[i + 1] - values[i]) * (along - static_cast<float>(i));
    s = values[i] + rise;
  } else {
    const bool lower = t <= 0.5f;
    const std::vector<float>& c = lower ? values : from_end_;
    const float u = lower ? t : 1 - t;
    for (auto value = c.rbegin(); value != c.rend(); ++value) {
      const float higher = s * u;
      s = higher + *value;
    }
    if (!lower) s = 1 - s;
  }
  return std::clamp(s, 0.0f, 1.0f);
}

std::string CurveShare::glsl() const {
  const auto literal = [](float value) {
    const std::string text = number_text(value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  };
  const std::string count = std::to_string(curve_.values.size());
  const auto list = [&](const std::string& name, const std::vector<float>& values) {
    std::string items;
    for (const float value : values) items += (items.empty() ? "" : ", ") + literal(value);
    return "const float " + name + "[" + count + "] = float[](" + items + ");\n";
  };
  if (curve_.kind == BlendCurve::Kind::table)
    return list("values", curve_.values) + "float share(float t) {\n  precise float along = t * float(" + count +
           " - 1);\n  int i = min(int(along), " + count + R"( - 2);
  precise float rise = (values[i + 1] - values[i]) * (along - float(i));
  precise float s = values[i] + rise;
  return s;
}
)";
  return list("from_begin", curve_.values) + list("from_end", from_end_) +
         "float share(float t) {\n  bool lower = t <= 0.5;\n  precise float u = lower ? t : 1.0 - t;\n"
         "  precise float s = 0.0;\n  for (int k = " +
         count + R"( - 1; k >= 0; --k) {
    precise float higher = s * u;
    s = higher + (lower ? from_begin[k] : from_end[k]);
  }
  precise float rest = 1.0 - s;
  return lower ? s : rest;
}
)";
}

}  // namespace lodestone
