#include "scoring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth.hpp"

namespace grapeshot::bench {

namespace {

Bin binOf(const Forecast* begin, const Forecast* end) {
    Bin bin;
    for (const Forecast* forecast = begin; forecast != end; ++forecast) {
        ++bin.count;
        bin.probability += forecast->probability;
        bin.share += forecast->collides ? 1 : 0;
    }
    bin.probability /= static_cast<double>(bin.count);
    bin.share /= static_cast<double>(bin.count);
    return bin;
}

}  // namespace

std::vector<Bin> binsOfEqualWidth(const std::vector<Forecast>& forecasts, std::size_t count) {
    std::vector<std::vector<Forecast>> members(count);
    for (const Forecast& forecast : forecasts) {
        const auto place = static_cast<std::size_t>(forecast.probability * static_cast<double>(count));
        members[std::min(place, count - 1)].push_back(forecast);
    }
    std::vector<Bin> bins;
    for (const std::vector<Forecast>& bin : members) {
        if (!bin.empty()) {
            bins.push_back(binOf(bin.data(), bin.data() + bin.size()));
        }
    }
    return bins;
}

std::vector<Bin> binsOfEqualCount(std::vector<Forecast> forecasts, std::size_t count) {
    std::ranges::sort(forecasts, {}, &Forecast::probability);
    std::vector<Bin> bins;
    std::size_t begin = 0;
    for (std::size_t i = 1; i <= count; ++i) {
        std::size_t end = std::max(begin, i * forecasts.size() / count);
        while (end > begin && end < forecasts.size() && forecasts[end].probability <= forecasts[end - 1].probability) {
            ++end;
        }
        if (end > begin) {
            bins.push_back(binOf(forecasts.data() + begin, forecasts.data() + end));
            begin = end;
        }
    }
    return bins;
}

double calibrationError(const std::vector<Bin>& bins) {
    double sum = 0;
    double count = 0;
    for (const Bin& bin : bins) {
        sum += static_cast<double>(bin.count) * std::abs(bin.probability - bin.share);
        count += static_cast<double>(bin.count);
    }
    return count > 0 ? sum / count : 0;
}

double areaUnderCurve(std::vector<Forecast> forecasts) {
    std::ranges::sort(forecasts, {}, &Forecast::probability);
    double above = 0;  // pairs of a clear and a colliding one in the right order
    double clear = 0;  // with less than what comes next
    for (std::size_t begin = 0; begin < forecasts.size();) {
        double tiedYes = 0;
        double tiedNo = 0;
        std::size_t end = begin;
        for (; end < forecasts.size() && forecasts[end].probability <= forecasts[begin].probability; ++end) {
            (forecasts[end].collides ? tiedYes : tiedNo) += 1;
        }
        above += tiedYes * (clear + 0.5 * tiedNo);
        clear += tiedNo;
        begin = end;
    }
    const double colliding = static_cast<double>(forecasts.size()) - clear;
    return colliding > 0 && clear > 0 ? above / (colliding * clear) : std::numeric_limits<double>::quiet_NaN();
}

Score score(const std::vector<Forecast>& forecasts) {
    Score result;
    Errors errors;
    std::vector<Forecast> doubtful;
    for (const Forecast& forecast : forecasts) {
        const double truth = forecast.collides ? 1 : 0;
        ++result.n;
        result.colliding += forecast.collides ? 1U : 0U;
        errors.add(forecast.probability >= 0.5, forecast.collides);
        result.brier += (forecast.probability - truth) * (forecast.probability - truth);
        if (forecast.probability > 0.1 && forecast.probability < 0.9) {
            doubtful.push_back(forecast);
        }
    }
    result.falseNegatives = errors.falseNegatives;
    result.falsePositives = errors.falsePositives;
    result.errorPercent = errors.percentOf(result.n);
    result.brier /= static_cast<double>(std::max<std::size_t>(1, result.n));
    result.auc = areaUnderCurve(forecasts);
    result.ece = calibrationError(binsOfEqualWidth(forecasts, 20));
    result.eceEqualCount = calibrationError(binsOfEqualCount(forecasts, 15));
    result.inDoubt = doubtful.size();
    result.eceInDoubt = calibrationError(binsOfEqualWidth(doubtful, 20));
    return result;
}

}  // namespace grapeshot::bench
