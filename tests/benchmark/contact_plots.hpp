// Charts of contact quality over time.
#pragma once

#include <string>
#include <vector>

namespace grapeshot::bench {

/// One method at all its budgets or levels.
struct ContactCurve {
    std::string name;
    std::vector<double> us, position, normal, recall;
    void add(double time, double positionPercent, double normalDegrees, double recallPercent) {
        us.push_back(time);
        position.push_back(positionPercent);
        normal.push_back(normalDegrees);
        recall.push_back(recallPercent);
    }
};

/// contacts_position_NAME.png, contacts_normal_NAME.png and contacts_recall_NAME.png: over the time of a query.
void drawContactPlots(const std::vector<ContactCurve>& curves, const std::string& name, const std::string& folder);

}  // namespace grapeshot::bench
