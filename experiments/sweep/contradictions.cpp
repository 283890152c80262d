#include "experiments/sweep/contradictions.h"

#include <map>
#include <set>

namespace lodestone {
namespace {

class ContradictionFinder {
 public:
  ContradictionFinder(const Design& design, const std::vector<Json>& settings, const Experiment& experiment,
                      const TomlTable& table)
      : design_(design), settings_(settings), experiment_(experiment), table_(table) {}

  void run() {
    for (std::size_t i = 0; i < settings_.size(); ++i) look_at(i);
    for (const auto& [name, use] : uses_)
      if (!has_effect_.contains(name)) fail(use.first, {name}, use.what + "; leave it out");
    refuse_equal_runs();
  }

 private:
  // The use of a parameter that has no effect in some settings.
  struct Use {
    std::size_t first = 0;  // of these settings
    std::string what;
  };

  void look_at(std::size_t i) {
    Json reduced = settings_[i];
    for (const SettingFault& fault : experiment_.check(Parameters(experiment_.parameters, settings_[i]))) {
      if (!fault.idle) fail(i, fault.parameters, fault.what);
      const std::string& name = fault.parameters.front();
      if (reduced.erase(name) > 0) uses_.try_emplace(name, Use{i, fault.what});
    }
    for (const auto& [name, value] : reduced.items()) has_effect_.insert(name);
    reduced_.push_back(std::move(reduced));
  }

  // Refuses settings that differ only in parameters without effect.
  void refuse_equal_runs() const {
    std::map<Json, std::size_t> known;
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      const auto [same, is_new] = known.try_emplace(Parameters(experiment_.parameters, reduced_[i]).json(), i);
      if (is_new) continue;
      for (const auto& [name, use] : uses_)
        if (!reduced_[i].contains(name) &&
            settings_[i].value(name, Json()) != settings_[same->second].value(name, Json()))
          fail(i, {name}, use.what + ", where its values make equal runs; vary it in a sweep without that");
    }
  }

  // At the last of the parameters that the setting gives; at the sweep where it gives none.
  [[noreturn]] void fail(std::size_t i, const std::vector<std::string>& names, const std::string& what) const {
    const toml::node* at = design_.list ? design_.list->get(i) : nullptr;
    for (const std::string& name : names)
      if (const toml::node* node = place_of(i, name)) at = node;
    table_.fail_at(at ? at->source() : table_.source(), what);
  }

  [[nodiscard]] const toml::node* place_of(std::size_t i, const std::string& name) const {
    if (design_.list) return design_.list->get(i)->as_table()->get(name);
    const auto found = design_.values.find(name);
    return found == design_.values.end() ? nullptr : found->second;
  }

  const Design& design_;
  const std::vector<Json>& settings_;
  const Experiment& experiment_;
  const TomlTable& table_;
  std::vector<Json> reduced_;  // settings without what has no effect
  std::map<std::string, Use> uses_;
  std::set<std::string> has_effect_;  // parameters, in a setting that gives them
};

}  // namespace

void refuse_contradictions(const Design& design, const std::vector<Json>& settings, const Experiment& experiment,
                           const TomlTable& table) {
  if (experiment.check) ContradictionFinder(design, settings, experiment, table).run();
}

}  // namespace lodestone
