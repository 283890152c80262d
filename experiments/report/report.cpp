#include "experiments/report/report.h"

namespace lodestone {

RunCounts Report::counts() const {
  RunCounts sum;
  for (const StudyReport& study : studies) sum += study.counts;
  return sum;
}

Report make_report(const std::vector<std::filesystem::path>& folders) {
  Report report;
  std::vector<Figure> all;
  for (const std::filesystem::path& folder : folders) {
    StudyReport entry{read_study(folder), {}, {}, {}, {}};
    for (const SweepRecord& sweep : entry.study.sweeps) {
      entry.tables.push_back(aggregate(sweep));
      entry.counts += count_runs(sweep);
    }
    for (const FigureRequest& request : entry.study.figures) {
      std::vector<const SettingTable*> tables;
      for (const std::string& name : request.sweeps)
        for (const SettingTable& table : entry.tables)
          if (table.sweep == name) tables.push_back(&table);
      entry.figures.push_back(make_figure(request, tables));
    }
    entry.oddities = list_oddities(entry.study);
    all.insert(all.end(), entry.figures.begin(), entry.figures.end());
    report.studies.push_back(std::move(entry));
  }
  report.plots = draw_plots(all);
  return report;
}

}  // namespace lodestone
