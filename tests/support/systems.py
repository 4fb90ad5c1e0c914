"""National reference systems, and a place in each."""

#: EPSG code, latitude and longitude.
NATIONAL = (
    ("EPSG:27700", 51.50, -0.12),  # Great Britain
    ("EPSG:29903", 53.35, -6.26),  # Ireland
    ("EPSG:2157", 53.35, -6.26),
    ("EPSG:2056", 46.95, 7.45),  # Switzerland
    ("EPSG:21781", 47.38, 8.54),
    ("EPSG:31256", 48.21, 16.37),  # Austria
    ("EPSG:31287", 47.27, 11.39),
    ("EPSG:31370", 50.85, 4.35),  # Belgium
    ("EPSG:28992", 52.37, 4.90),  # Netherlands
    ("EPSG:31467", 50.11, 8.68),  # Germany
    ("EPSG:25832", 50.11, 8.68),
    ("EPSG:5514", 50.08, 14.42),  # Czechia
    ("EPSG:2100", 37.98, 23.73),  # Greece
    ("EPSG:3021", 59.33, 18.06),  # Sweden
    ("EPSG:3006", 59.33, 18.06),
    ("EPSG:23030", 40.42, -3.70),  # Spain
    ("EPSG:2154", 45.76, 4.84),  # France
    ("EPSG:27572", 45.76, 4.84),
    ("EPSG:3003", 45.46, 9.19),  # Italy
    ("EPSG:20790", 38.72, -9.14),  # Portugal
    ("EPSG:3763", 38.72, -9.14),
    ("EPSG:2180", 52.23, 21.01),  # Poland
    ("EPSG:2393", 60.17, 24.94),  # Finland
    ("EPSG:23700", 47.50, 19.04),  # Hungary
    ("EPSG:3844", 44.43, 26.10),  # Romania
    ("EPSG:3912", 46.05, 14.50),  # Slovenia
    ("EPSG:3765", 45.81, 15.98),  # Croatia
    ("EPSG:28404", 55.75, 24.00),  # Pulkovo 1942
    ("EPSG:2039", 32.08, 34.78),  # Israel
    ("EPSG:20935", -15.40, 28.30),  # Zambia
    ("EPSG:24547", 3.14, 101.69),  # Malaysia
    ("EPSG:29873", 4.90, 114.94),  # Brunei
    ("EPSG:2326", 22.30, 114.17),  # Hong Kong
    ("EPSG:3826", 25.03, 121.56),  # Taiwan
    ("EPSG:6677", 35.68, 139.69),  # Japan
    ("EPSG:27200", -41.29, 174.78),  # New Zealand
    ("EPSG:7856", -33.87, 151.21),  # Australia
    ("EPSG:2263", 40.71, -74.00),  # New York, in feet
    ("EPSG:3347", 45.42, -75.70),  # Canada
    ("EPSG:29193", -23.55, -46.63),  # Brazil
    ("EPSG:5880", -15.79, -47.88),
    ("EPSG:21897", 4.71, -74.07),  # Colombia
)
