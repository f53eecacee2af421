/// @file report_style.h  How all report pages look.
#pragma once

namespace epafi {

/// Letters of pictures, as part of their height: three beside each other are 220 pixels high on the page.
inline constexpr double report_letters = 1.0 / 20;

inline constexpr const char* report_style = R"(<style>
:root{color-scheme:light;--ink:#1d2430;--soft:#667085;--line:#e3e6ec;--good:#1a7f4b;--bad:#b42318;--bar:#3b6ea5}
body{font:15px/1.5 system-ui,"DejaVu Sans",sans-serif;color:var(--ink);max-width:1080px;margin:2rem auto;
padding:0 1.2rem;background:#fff}h1{font-size:1.6rem;margin:0 0 .2rem}
h2{font-size:1.1rem;margin:2rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.25rem}
h1,p,figcaption,.card{overflow-wrap:anywhere}
td,th{overflow-wrap:break-word;word-break:normal}
p.sub{color:var(--soft);margin:0 0 1rem}table{border-collapse:collapse;width:100%}
td,th{text-align:left;padding:.28rem .7rem .28rem 0;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--soft);font-weight:600}td.n{font-variant-numeric:tabular-nums;white-space:nowrap}
.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(460px,100%),1fr));gap:1rem;margin-bottom:.8rem}
figure{margin:0;border:1px solid var(--line);border-radius:6px;padding:.4rem}
figure img,figure svg{width:100%;height:auto;max-height:44rem;object-fit:contain;display:block}
figcaption{color:var(--soft);font-size:.85rem;padding:.3rem .2rem 0}
.three{grid-template-columns:repeat(auto-fit,minmax(min(300px,100%),1fr))}.cards{display:flex;flex-wrap:wrap;gap:.6rem}
.card{border:1px solid var(--line);border-radius:6px;padding:.5rem .8rem;min-width:8.5rem}
.card b{display:block;font-size:1.15rem;font-variant-numeric:tabular-nums}
.card span{color:var(--soft);font-size:.82rem}
.warning{border-left:4px solid #c77700;background:#fff7e8;padding:.4rem .8rem;margin:.4rem 0}
.wide{overflow-x:auto;margin-bottom:.6rem;background:linear-gradient(to right,#fff 2rem,#fff0) 0 0/4rem 100% local
no-repeat,linear-gradient(to left,#fff 2rem,#fff0) 100% 0/4rem 100% local no-repeat,
linear-gradient(to right,#1d243055,#1d243000) 0 0/1.2rem 100% scroll no-repeat,
linear-gradient(to left,#1d243055,#1d243000) 100% 0/1.2rem 100% scroll no-repeat,#fff}
.data td,.data th{white-space:nowrap;padding-right:1.1rem}
.data th{white-space:normal;vertical-align:bottom;min-width:4.6rem}
details.warnings summary{cursor:pointer;color:var(--soft)}
.data .long{white-space:normal;min-width:16rem;max-width:30rem;max-height:7.5rem;overflow-y:auto}
iframe{width:100%;height:640px;border:1px solid var(--line);border-radius:6px}th.n,td.n{text-align:right}
.ok{color:var(--good)}.no{color:var(--bad)}.bar{height:.9rem;background:var(--bar);border-radius:2px;min-width:1px}
pre{background:#f6f7f9;border:1px solid var(--line);border-radius:6px;padding:.8rem;overflow-x:auto;font-size:.82rem;
line-height:1.4}
</style>)";

}  // namespace epafi
