#include "compiler/report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kiln::report {

namespace {

constexpr double width = 430, height = 400, left = 58, right = 16, top = 34, bottom = 48;
constexpr double least_time = 0.02;  // ns: below, a difference of two loops says nothing

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", v);
    return text;
}

struct Axis {
    double low = 0, high = 1, from = 0, to = 1;  // logarithms, and where they stand
    double at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
};

// Whole decades around the values, at least `decades` of them.
Axis axis_over(double least, double most, double from, double to) {
    Axis a{std::floor(std::log10(least) - 0.05), std::ceil(std::log10(most) + 0.05), from, to};
    if (a.high - a.low < 1.0) a.high = a.low + 1.0;
    return a;
}

std::string power(double exponent) {
    const int e = static_cast<int>(std::lround(exponent));
    if (e >= -2 && e <= 3) {
        char text[32];
        std::snprintf(text, sizeof text, "%g", std::pow(10.0, e));
        return text;
    }
    return "1e" + std::to_string(e);
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

Box label_size(const std::string& label, bool bold) {
    size_t letters = 0;
    for (const char c : label) letters += (static_cast<unsigned char>(c) & 0xc0u) != 0x80u ? 1 : 0;
    return {0, 0, (bold ? 8.2 : 7.4) * static_cast<double>(letters) + 4.0, 15.0};
}

std::vector<Box> place_labels(const std::vector<std::string>& labels, const std::vector<std::pair<double, double>>& points,
                              const Box& area, const std::vector<bool>& bold) {
    constexpr double radius = 6.0;
    std::vector<Box> taken, out(labels.size());
    for (const auto& [x, y] : points) taken.push_back({x - radius, y - radius, 2 * radius, 2 * radius});
    // Crowded points choose first, else their few free places go to others.
    std::vector<size_t> order(labels.size());
    std::vector<size_t> neighbours(labels.size(), 0);
    for (size_t i = 0; i < labels.size(); ++i) {
        order[i] = i;
        for (const auto& [x, y] : points)
            if (std::hypot(x - points[i].first, y - points[i].second) < 60.0) ++neighbours[i];
    }
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return neighbours[a] > neighbours[b]; });
    for (const size_t i : order) {
        const Box size = label_size(labels[i], i < bold.size() && bold[i]);
        const auto [x, y] = points[i];
        bool found = false;
        for (int step = 0; step < 14 && !found; ++step) {
            const double d = 8.0 + 9.0 * step;
            const std::array<std::pair<double, double>, 8> places{{{x + d, y - size.h / 2},
                                                                   {x - d - size.w, y - size.h / 2},
                                                                   {x - size.w / 2, y - d - size.h},
                                                                   {x - size.w / 2, y + d},
                                                                   {x + 0.7 * d, y - 0.7 * d - size.h},
                                                                   {x + 0.7 * d, y + 0.7 * d},
                                                                   {x - 0.7 * d - size.w, y - 0.7 * d - size.h},
                                                                   {x - 0.7 * d - size.w, y + 0.7 * d}}};
            for (const auto& [px, py] : places) {
                const Box b{px, py, size.w, size.h};
                if (b.x < area.x || b.y < area.y || b.x + b.w > area.x + area.w || b.y + b.h > area.y + area.h) continue;
                if (std::any_of(taken.begin(), taken.end(), [&](const Box& t) { return t.overlaps(b); })) continue;
                taken.push_back(b);
                out[i] = b;
                found = true;
                break;
            }
        }
    }
    return out;
}

std::string plot_svg(const std::string& title, const std::string& error_name, const std::vector<Mark>& marks) {
    std::string s = "<svg class=\"plot\" viewBox=\"0 0 " + number(width) + " " + number(height) +
                    "\" role=\"img\" aria-label=\"" + escaped(title) + "\">";
    std::vector<Mark> drawn;
    for (const Mark& m : marks)
        if (std::isfinite(m.error) && std::isfinite(m.time)) drawn.push_back(m);
    double least = 0, most = 0, fast = 0, slow = 0;
    bool zeros = false;
    for (Mark& m : drawn) {
        m.time = std::max(m.time, least_time);
        fast = fast == 0 ? m.time : std::min(fast, m.time);
        slow = std::max(slow, m.time);
        if (m.error <= 0) {
            zeros = true;
            continue;
        }
        least = least == 0 ? m.error : std::min(least, m.error);
        most = std::max(most, m.error);
    }
    if (least == 0) least = most = 1;
    if (fast == 0) fast = slow = 1;
    const double floor_y = height - bottom, zero_y = floor_y - 10;
    const Axis x = axis_over(fast, slow, left, width - right);
    const Axis y = axis_over(least, most, zeros ? floor_y - 26 : floor_y, top);

    const auto decades = [](const Axis& axis) { return static_cast<int>(std::floor(axis.high - axis.low + 0.5)); };
    for (int i = 0; i <= decades(x); ++i) {
        const double e = x.low + i;
        const double at = x.at(std::pow(10.0, e));
        s += "<line class=\"grid\" x1=\"" + number(at) + "\" x2=\"" + number(at) + "\" y1=\"" + number(top) + "\" y2=\"" +
             number(floor_y) + "\"/><text class=\"tick\" text-anchor=\"middle\" x=\"" + number(at) + "\" y=\"" +
             number(floor_y + 15) + "\">" + power(e) + "</text>";
    }
    const int every = std::max(1, static_cast<int>(std::ceil((y.high - y.low) / 9.0)));
    for (int i = 0; i <= decades(y); i += every) {
        const double e = y.low + i;
        const double at = y.at(std::pow(10.0, e));
        s += "<line class=\"grid\" x1=\"" + number(left) + "\" x2=\"" + number(width - right) + "\" y1=\"" + number(at) +
             "\" y2=\"" + number(at) + "\"/><text class=\"tick\" text-anchor=\"end\" x=\"" + number(left - 5) + "\" y=\"" +
             number(at + 4) + "\">" + power(e) + "</text>";
    }
    if (zeros)
        s += "<line class=\"grid zero\" x1=\"" + number(left) + "\" x2=\"" + number(width - right) + "\" y1=\"" + number(zero_y) +
             "\" y2=\"" + number(zero_y) + "\"/><text class=\"tick\" text-anchor=\"end\" x=\"" + number(left - 5) + "\" y=\"" +
             number(zero_y + 4) + "\">0</text>";
    s += "<text class=\"title\" x=\"" + number(left) + "\" y=\"18\">" + escaped(title) + "</text>";
    s += "<text class=\"axis\" text-anchor=\"middle\" x=\"" + number((left + width - right) / 2) + "\" y=\"" +
         number(height - 10) + "\">ns a pixel over an empty loop</text>";
    s += "<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(14 " + number((top + floor_y) / 2) +
         ") rotate(-90)\">" + escaped(error_name) + "</text>";

    std::vector<std::pair<double, double>> points;
    std::vector<std::string> labels;
    std::vector<bool> bold;
    for (const Mark& m : drawn) {
        bold.push_back(m.front);
        points.emplace_back(x.at(m.time), m.error <= 0 ? zero_y : y.at(m.error));
        labels.push_back(m.label);
    }
    std::vector<size_t> front;
    for (size_t i = 0; i < drawn.size(); ++i)
        if (drawn[i].front) front.push_back(i);
    std::sort(front.begin(), front.end(), [&](size_t a, size_t b) { return points[a].first < points[b].first; });
    std::string path;
    for (size_t k = 0; k < front.size(); ++k) {
        const auto [px, py] = points[front[k]];
        path += k == 0 ? "M" + number(px) + " " + number(py) : " H" + number(px) + " V" + number(py);
    }
    if (!path.empty()) s += "<path class=\"front\" d=\"" + path + "\"/>";

    const std::vector<Box> boxes = place_labels(labels, points, {left + 2, top, width - left - right - 4, floor_y - top}, bold);
    for (size_t i = 0; i < drawn.size(); ++i) {
        const auto [px, py] = points[i];
        s += std::string("<g class=\"point") + (drawn[i].front ? " on-front" : "") +
             "\" tabindex=\"0\" role=\"button\" data-row=\"" + escaped(drawn[i].id) + "\" aria-label=\"" +
             escaped(drawn[i].tooltip) + "\"><title>" + escaped(drawn[i].tooltip) + "</title>";
        const Box& b = boxes[i];
        if (b.w > 0) {
            const double near_x = std::clamp(px, b.x, b.x + b.w), near_y = std::clamp(py, b.y, b.y + b.h);
            if (std::hypot(near_x - px, near_y - py) > 14)
                s += "<line class=\"leader\" x1=\"" + number(px) + "\" y1=\"" + number(py) + "\" x2=\"" + number(near_x) +
                     "\" y2=\"" + number(near_y) + "\"/>";
        }
        s += "<circle class=\"reach\" cx=\"" + number(px) + "\" cy=\"" + number(py) + "\" r=\"13\"/><circle class=\"dot\" cx=\"" +
             number(px) + "\" cy=\"" + number(py) + "\" r=\"5\"/>";
        if (b.w > 0)
            // Held where it meets its point, since a font may be narrower than thought.
            s += (b.x + b.w <= px ? "<text class=\"label\" text-anchor=\"end\" x=\"" + number(b.x + b.w - 2)
                                  : "<text class=\"label\" x=\"" + number(b.x + 2)) +
                 "\" y=\"" + number(b.y + 11.5) + "\">" + escaped(labels[i]) + "</text>";
        s += "</g>";
    }
    return s + "</svg>";
}

}  // namespace kiln::report
